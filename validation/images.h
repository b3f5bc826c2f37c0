#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "contact/sources.h"
#include "validation.h"

/// Helpers shared by the contact cases: images as lists of pixels, and sources with deliberate defects.
namespace palpate::validation {

/// Returns whether contact images are available: the build includes them, and an EGL device opens.
bool images_work();
/// Adds a line to the report that states that images were skipped and why; adds nothing if they work.
void say_what_is_skipped(std::vector<Measurement>& out);

/// Returns the pixels of an image-space source as samples: both points in world axes (frame 0), each with the
/// area of one pixel.
std::vector<contact::ContactSample> pixels_of(contact::SampleSource& source,
                                              const dynamics::StateView& state);
double overlap_volume(const std::vector<contact::ContactSample>& samples);  ///< Sum of depth x area [m^3].

/// Returns a source whose samples `seed_defect` changes after each query: the library with a defect.
using Spoil = std::function<void(std::vector<contact::ContactSample>& samples)>;
std::unique_ptr<contact::SampleSource> spoiled(std::unique_ptr<contact::SampleSource> source,
                                               Spoil seed_defect);

/// Returns a source whose samples remain those of the last query: gaps are linear in the positions, and their
/// tangent is exact.
std::unique_ptr<contact::SampleSource> held(std::unique_ptr<contact::SampleSource> source);

/// Displacement of an image's pixel grid.
struct GridShift {
  double u, v;  ///< [pixels]
};
/// Unstructured shifts of the pixel grid: the lattice of the golden ratios in two dimensions.
inline constexpr int kGridShifts = 20;
GridShift grid_shift(int i);
/// Measures a sum over an image's pixels with images of increasing resolution, each by its RMS over 20
/// shifts of the grid: error at the last resolution, and order in pixel size.
/// @param requested quantity, exact value, acceptance limit and bounds of the order
/// @param pixels resolutions, ascending: pixels along the longer edge
/// @param sampled returns the sum for (pixels along the longer edge, shift)
Measurement over_pixels(Measurement requested, const std::vector<int>& pixels,
                        const std::function<double(int, const GridShift&)>& sampled);

}  // namespace palpate::validation
