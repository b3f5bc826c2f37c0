#pragma once
#include "validation.h"

/// Validation cases, one function per case and file; registry.cpp lists them in order.
namespace palpate::validation {

ValidationCase spheres_field();
ValidationCase overlap_volume();
ValidationCase volume_on_plane();
ValidationCase box_corner();
ValidationCase corrugated_plates();
ValidationCase vertex_list();
ValidationCase order_independence();
ValidationCase sphere_on_plane();
ValidationCase punch_bounce();
ValidationCase punch_bounce_damped();
ValidationCase punch_bounce_hunt_crossley();
ValidationCase rocking_box();
ValidationCase balance();
ValidationCase closed_loop();
ValidationCase elastic_foundation_peer();
ValidationCase resting_sphere();
ValidationCase block_on_incline();
ValidationCase rolling_sphere();
ValidationCase sliding_in_fixed_steps();
ValidationCase felt_detail();
ValidationCase contact_refresh();
ValidationCase patch_test();
ValidationCase rigid_motion();
ValidationCase gradient_and_tangent();
ValidationCase uniaxial_and_shear();
ValidationCase hanging_bar();
ValidationCase layered_bar();
ValidationCase cantilever();
ValidationCase large_deflection();
ValidationCase torsion();
ValidationCase locking();
ValidationCase newton_convergence();
ValidationCase contact_patch();
ValidationCase flat_punch();
ValidationCase hertz_sphere();
ValidationCase deep_dent();
ValidationCase free_vibration();
ValidationCase vibration_tolerance();
ValidationCase spinning_body();
ValidationCase axial_vibration();
ValidationCase two_material_bar();
ValidationCase bar_on_bone();
ValidationCase lame_mode();
ValidationCase bending_vibration();
ValidationCase explicit_limit();
ValidationCase dropped_ball();
ValidationCase colliding_bars();
ValidationCase handle_step();
ValidationCase handle_below_wall();
ValidationCase free_top();
ValidationCase coupling_limit();
ValidationCase sampled_wall();
ValidationCase partitioned_monolithic();
ValidationCase device_limits();

}  // namespace palpate::validation
