#include "cases.h"
#include "palpate/tool/tool.h"

namespace palpate::validation {

const std::vector<ValidationCase>& validation_cases() {
  static const std::vector<ValidationCase> cases = [] {
    std::vector<ValidationCase> out;
    const auto add = [&out](std::vector<ValidationCase> some) {
      out.insert(out.end(), some.begin(), some.end());
    };
    add({spheres_field(), overlap_volume(), volume_on_plane(), box_corner(), corrugated_plates(),
         vertex_list(), order_independence(), sphere_on_plane(), punch_bounce(), punch_bounce_damped(),
         punch_bounce_hunt_crossley(), rocking_box(), balance(), closed_loop(), contact_refresh(),
         sliding_in_fixed_steps()});
    if (tool::available())
      add({elastic_foundation_peer(), resting_sphere(), block_on_incline(), rolling_sphere(), felt_detail()});
    add({patch_test(),
         rigid_motion(),
         gradient_and_tangent(),
         uniaxial_and_shear(),
         hanging_bar(),
         layered_bar(),
         cantilever(),
         large_deflection(),
         torsion(),
         newton_convergence(),
         locking(),
         contact_patch(),
         flat_punch(),
         hertz_sphere(),
         deep_dent(),
         free_vibration(),
         vibration_tolerance(),
         axial_vibration(),
         two_material_bar(),
         bar_on_bone(),
         lame_mode(),
         bending_vibration(),
         spinning_body(),
         explicit_limit(),
         dropped_ball(),
         colliding_bars()});
    if (tool::available())
      add({handle_step(), handle_below_wall(), free_top(), coupling_limit(), partitioned_monolithic()});
    add({device_limits(), sampled_wall()});
    return out;
  }();
  return cases;
}

}  // namespace palpate::validation
