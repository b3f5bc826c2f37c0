#pragma once
#include <vector>

#include "render/scene.h"

namespace palpate::render {

/// Returns the visible share of the scene's subjects (Surface::subject) for a distant eye: of the area that
/// they cover in an image that frames them, the part not hidden by opaque surfaces, in [0, 1]; 1 without
/// subjects. Translucent surfaces (Surface::opacity below 1) hide nothing.  Accurate to a few hundredths: the
/// image has 64 pixels along its longer edge.
double visible_share(const Scene& scene, const View& view);

/// Chooses the view with the largest visible share of the subjects, over one or more snapshots of a scene.
/// The first candidate is the usual view, View{}; it is kept unless it shows a third or less, and another
/// shows more than a third and at least 1.5 times as much: pictures of different scenes are easier to compare
/// from one side.
class ViewChoice {
 public:
  ViewChoice();
  /// Adds a snapshot.
  void add(const Scene& instant);
  /// Returns the chosen view.  @param from_below  whether the eye may be below the horizon: not where there
  /// is a ground
  View best(bool from_below) const;

 private:
  std::vector<View> views_;
  std::vector<double> seen_;
  int instants_ = 0;
};

}  // namespace palpate::render
