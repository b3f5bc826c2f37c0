#include "session/scene_view.h"

namespace palpate::session {

render::View scene_view(const scene::ViewSpec& spec, const render::View& chosen) {
  render::View view = chosen;
  if (spec.direction) view.backwards = *spec.direction;
  view.target = spec.target_m;
  view.zoom = spec.zoom;
  view.up = spec.up;
  return view;
}

}  // namespace palpate::session
