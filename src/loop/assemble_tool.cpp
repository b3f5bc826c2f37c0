#include "assemble_parts.h"
#include "palpate/core/error.h"
#include "palpate/integrate/integrators.h"
#ifdef PALPATE_HAS_TOOL
#include "palpate/tool/tool.h"
#endif

namespace palpate::loop {

void assemble_tool([[maybe_unused]] World& world) {
#ifdef PALPATE_HAS_TOOL
  const scene::Description& d = world.description;
  if (d.coupling.scheme != "partitioned")
    fail("exchange: unknown scheme \"{}\"{}", d.coupling.scheme, suggestion(d.coupling.scheme, {"partitioned"}));
  world.tool = std::make_unique<tool::Tool>(*d.tool, d.tool->gravity ? d.gravity_m_s2 : Vec3(Vec3::Zero()));
  world.handle = device::make_handle(*d.device);
  world.limiter = std::make_unique<device::WrenchLimiter>(d.device->max_force_n, d.device->max_torque_n_m, d.device->ramp_s);
#else
  fail("[tool]: this palpate was built without rigid tools; configure with -DPALPATE_WITH_TOOL=ON (package libsimbody-dev)");
#endif
}

TriMesh tool_surface(const ToolSpec& spec, const std::string& folder) {
  if (spec.shape == "mesh") return mesh::surface(spec.mesh, folder);
  MeshSpec ball;
  ball.generator = "ball";
  ball.radius_m = spec.radius_m;
  ball.element_size_m = spec.radius_m / 8.0;
  return mesh::surface(ball, folder);
}

}  // namespace palpate::loop
