#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "palpate/contact/sources.h"
#include "palpate/validation/validation.h"

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
std::unique_ptr<contact::SampleSource> spoiled(std::unique_ptr<contact::SampleSource> source, Spoil spoil);

/// Shifts of the pixel grid without structure: the lattice of the golden ratios of two dimensions.
struct GridShift {
  double u, v;
};
inline constexpr int kGridShifts = 20;
GridShift grid_shift(int i);

}  // namespace palpate::validation
