#pragma once
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "palpate/contact/sources.h"
#include "palpate/validation/validation.h"

/// What the cases in image space share: which backends there are, and a source that is broken on purpose.
namespace palpate::validation {

/// `cpu`, `exact`, and `gpu` where an EGL device opens.  A fault is of what all share: with one, `cpu` alone.
std::vector<contact::DepthBackend> image_backends(const std::string& fault);

/// A line in the report that says that `gpu` was left out and why; nothing where it was not.
void say_what_is_skipped(std::vector<Measurement>& out);

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
