#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "contact/sources.h"
#include "validation.h"

/// What the contact cases share: images as lists of pixels, and a source that is broken on purpose.
namespace palpate::validation {

/// Whether contact images can be made here: the build has them, and an EGL device opens.
bool images_work();
/// A line in the report that says that images were left out and why; nothing where they were not.
void say_what_is_skipped(std::vector<Measurement>& out);

/// The pixels of what a source in image space sees, as samples: both points in the world's axes (frame 0),
/// one pixel's area each.
std::vector<contact::ContactSample> pixels_of(contact::SampleSource& source,
                                              const dynamics::StateView& state);
double overlap_volume(const std::vector<contact::ContactSample>& samples);  ///< sum of depth x area [m^3]

/// A source whose samples `spoil` changes after each query: the library with a defect.
using Spoil = std::function<void(std::vector<contact::ContactSample>& samples)>;
std::unique_ptr<contact::SampleSource> spoiled(std::unique_ptr<contact::SampleSource> source,
                                               Spoil seed_defect);

/// A source whose samples stay those of the last query: gaps are linear in the positions, and their tangent
/// is exact.
std::unique_ptr<contact::SampleSource> held(std::unique_ptr<contact::SampleSource> source);

/// How far the grid of an image's pixels is moved.
struct GridShift {
  double u, v;  ///< [pixels]
};
/// Shifts of the pixel grid without structure: the lattice of the golden ratios of two dimensions.
inline constexpr int kGridShifts = 20;
GridShift grid_shift(int i);
/// Measures what an image's pixels sum up to with images of more and more pixels, each by its RMS over 20
/// shifts of the grid: error at the last one, and order in pixel size.
/// @param wanted   quantity, exact value, bar and bounds of the order
/// @param sampled  (pixels along the longer edge, shift)
Measurement over_pixels(Measurement requested, const std::vector<int>& pixels,
                        const std::function<double(int, const GridShift&)>& sampled);

}  // namespace palpate::validation
