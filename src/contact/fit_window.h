#pragma once
#include <limits>

#include "contact/contact_view.h"

namespace palpate::contact {

/// Performs the cuts of fit_window() (contact_view.h), for any storage of faces.
/// @param box_a, box_b  bounds of the faces
/// @param cut_a, cut_b  (window): remove the faces that do not reach into the window, and return the
///   bounds of the others, with low above high where none is left
template <class CutA, class CutB>
ContactWindow cut_to_window(AxisBox box_a, AxisBox box_b, double candidate_gap, CutA cut_a, CutB cut_b) {
  constexpr int kCuts = 3;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (int i = 0; i < kCuts; ++i) {
    AxisBox window_a, window_b;
    window_a.low = window_b.low = box_a.low.cwiseMax(box_b.low);
    window_a.high = window_b.high = box_a.high.cwiseMin(box_b.high);
    window_a.low.z() = -kInfinity;
    window_a.high.z() = box_b.high.z() + candidate_gap;
    window_b.low.z() = box_a.low.z() - candidate_gap;
    window_b.high.z() = kInfinity;
    box_a = cut_a(window_a);
    box_b = cut_b(window_b);
    if (!(box_a.low.x() <= box_a.high.x()) || !(box_b.low.x() <= box_b.high.x())) return {};
  }
  ContactWindow out;
  out.low = box_a.low.cwiseMax(box_b.low).head<2>();
  out.high = box_a.high.cwiseMin(box_b.high).head<2>();
  out.near = box_a.low.z() - candidate_gap;
  out.far = box_b.high.z() + candidate_gap;
  const double room = 1e-3 * (out.far - out.near);  // Margin at both ends of the depth range.
  out.near -= room;
  out.far += room;
  return out;
}

}  // namespace palpate::contact
