#include "rest_elements.h"

#include <cmath>

#include <Eigen/LU>

#include "palpate/core/error.h"

namespace palpate::fem {

RestElements make_rest_elements(const TetMesh& rest, std::string_view where) {
  const auto count = static_cast<std::size_t>(rest.tets.cols());
  RestElements out;
  for (auto& nodes : out.node) nodes.resize(count);
  for (auto& entries : out.inverse_edges) entries.resize(count);
  out.volume.resize(count);
  out.nodal_volume.assign(static_cast<std::size_t>(rest.nodes.cols()), 0.0);
  for (std::size_t e = 0; e < count; ++e) {
    const auto tet = rest.tets.col(static_cast<Eigen::Index>(e));
    for (int a = 0; a < 4; ++a) {
      if (tet[a] < 0 || tet[a] >= rest.nodes.cols())
        fail("{}: element {} refers to node {} of {}; node numbers start at 0", where, e, tet[a],
             rest.nodes.cols());
      out.node[static_cast<std::size_t>(a)][e] = tet[a];
    }
    Mat3 Dm;
    for (int a = 0; a < 3; ++a) Dm.col(a) = rest.nodes.col(tet[a + 1]) - rest.nodes.col(tet[0]);
    const double volume = Dm.determinant() / 6.0;
    if (!(std::isfinite(volume) && volume > 0.0))
      fail(
          "{}: element {} (nodes {} {} {} {}) has volume {} m^3, which must be positive; mesh::tet_mesh "
          "corrects the orientation",
          where, e, tet[0], tet[1], tet[2], tet[3], volume);
    const Mat3 inverse = Dm.inverse();
    for (int r = 0; r < 3; ++r)
      for (int c = 0; c < 3; ++c) out.inverse_edges[static_cast<std::size_t>(3 * r + c)][e] = inverse(r, c);
    out.volume[e] = volume;
    for (int a = 0; a < 4; ++a) out.nodal_volume[static_cast<std::size_t>(tet[a])] += 0.25 * volume;
  }
  return out;
}

}  // namespace palpate::fem
