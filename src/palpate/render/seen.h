#pragma once
#include <vector>

#include "palpate/render/scene.h"

namespace palpate::render {

/// How much of the scene's subjects (Surface::subject) an eye far away sees: of the area that they cover in
/// an image that frames them, the part where nothing opaque stands in front; 0 to 1.  1 where there are none.
/// What is not opaque (Surface::opacity below 1) hides nothing.  To a few hundredths: the image has 64 pixels
/// along its longer edge.
double seen_share(const Scene& scene, const View& view);

/// The view from which most of the subjects is seen, over one or more instants of a scene.  The first
/// candidate is the usual view, View{}; it stays unless a third or less is seen from it, and another shows a
/// third and half as much again: pictures of different scenes are easier to read from one side.
class ViewChoice {
 public:
  ViewChoice();
  void add(const Scene& instant);
  /// @param from_below  whether the eye may stand below the horizon: not where there is a ground
  View best(bool from_below) const;

 private:
  std::vector<View> views_;
  std::vector<double> seen_;
  int instants_ = 0;
};

}  // namespace palpate::render
