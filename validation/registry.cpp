#include "cases.h"

namespace palpate::study {

const std::vector<ValidationCase>& validation_cases() {
  static const std::vector<ValidationCase> cases = {
#ifdef PALPATE_HAS_gl
      validation::overlap_volume(),
#endif
      validation::sphere_on_plane(),
      validation::punch_bounce(),
      validation::punch_bounce_damped(),
      validation::punch_bounce_hunt_crossley(),
      validation::patch_test(),
      validation::rigid_motion(),
      validation::gradient_and_tangent(),
      validation::uniaxial_and_shear(),
      validation::hanging_bar(),
      validation::layered_bar(),
      validation::cantilever(),
      validation::large_deflection(),
      validation::torsion(),
      validation::newton_convergence(),
      validation::locking(),
      validation::free_vibration(),
      validation::vibration_tolerance(),
      validation::axial_vibration(),
      validation::two_material_bar(),
      validation::bar_on_bone(),
      validation::lame_mode(),
      validation::bending_vibration(),
      validation::spinning_body(),
      validation::explicit_limit(),
      validation::dropped_ball(),
#ifdef PALPATE_HAS_tool
      validation::handle_step(),
      validation::handle_below_wall(),
      validation::coupling_limit(),
      validation::partitioned_monolithic(),
#endif
      validation::device_limits(),
  };
  return cases;
}

}  // namespace palpate::study
