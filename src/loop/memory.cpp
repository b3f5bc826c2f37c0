#include "loop/memory.h"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>

#include "palpate/integrate/integrators.h"
#include "palpate/loop/world.h"
#include "scene/contact_sides.h"

namespace palpate::loop {
namespace {

constexpr double kMiB = 1024.0 * 1024.0;

/// Returns the bytes of a factor divided by N^(4/3). Nested dissection of a three-dimensional mesh leaves
/// O(N^(4/3)) numbers in the factor for N nodes (George 1973; Lipton, Rose and Tarjan 1979). Measured for
/// cholmod: 645 on cubes of 1,331 to 39,304 nodes, 900 to 1,300 on a ball of 8,217 and 600 on one of 33,153;
/// for umfpack 1,600 to 1,800 on cubes.
double factor_constant(const std::string& solver) {
  if (solver == "cholmod") return 800.0;
  if (solver == "umfpack") return 2000.0;
  return 0.0;  // conjugate gradients have no factor
}

/// Returns the stack size of a thread: the limit for the main thread is the default for all others
/// (pthread_create(3)).
double stack_bytes() {
  constexpr double kUsual = 8.0 * kMiB;
  rlimit stack{};
  const bool limited = ::getrlimit(RLIMIT_STACK, &stack) == 0 && stack.rlim_cur != RLIM_INFINITY;
  return limited ? static_cast<double>(stack.rlim_cur) : kUsual;
}

/// Returns the number of nearest-point contacts of a body.
int contacts_by_points(const scene::Description& d, std::size_t body) {
  return static_cast<int>(std::count_if(d.contacts.begin(), d.contacts.end(), [&](const ContactSpec& c) {
    const std::string& name = d.bodies[body].name;
    return (c.first == name || c.second == name) && scene::contact_method(d, c) == "distance";
  }));
}

/// Returns whether a tool exchanges contact linearised at points with bodies; it then has a matrix and a
/// solver in addition to the integrator's.
bool touches_at_points(const scene::Description& d) {
  return d.tool && !d.exchange.has_tools_in_state() && d.exchange.linearisation == "points";
}

}  // namespace

MeshCounts counts_of(const Body& body) {
  return {static_cast<int>(body.rest.nodes.cols()), static_cast<int>(body.rest.tets.cols()),
          body.skin ? static_cast<int>(body.skin->rest.vertices.cols()) : 0};
}

MemoryEstimate estimate_memory(const scene::Description& description, const std::vector<MeshCounts>& bodies) {
  constexpr double kProgram = 40.0 * kMiB, kTetrahedron = 820.0, kTouched = 640.0, kSkinVertex = 200.0;
  // Three contact points per vertex of 320 bytes each (measured, 600,000 points), if faces are not
  // subdivided.
  constexpr double kPointsOfVertex = 3.0 * 320.0;
  constexpr double kBlas = 128.0 * kMiB;  // measured for OpenBLAS 0.3.21, one thread
  const bool at_points = touches_at_points(description);
  MemoryEstimate out{.program = kProgram};
  const double constant =
      (at_points ? 2.0 : 1.0) * factor_constant(integrate::linear_solver_of(description.integrator));
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const MeshCounts& body = bodies[i];
    out.elements += kTetrahedron * body.tetrahedra;
    if (at_points) out.touch += kTouched * body.tetrahedra;
    const int pointed = i < description.bodies.size() ? contacts_by_points(description, i) : 0;
    out.skins += (kSkinVertex + pointed * kPointsOfVertex) * body.skin_vertices;
    out.factor += constant * std::pow(body.nodes, 4.0 / 3.0);
  }
  if (constant > 0.0) out.addresses += kBlas;
  out.addresses += (description.integrator.threads - 1) * stack_bytes();
  return out;
}

}  // namespace palpate::loop
