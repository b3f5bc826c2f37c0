// Stable neo-Hookean law in SIMD lanes; derivation and scalar formulas: stable_neo_hookean.cpp.
#ifdef __AVX2__
#include <immintrin.h>
#endif

#include "fem/lane_kernels.h"

namespace palpate::fem::PALPATE_KERNELS {
namespace {

#include "fem/lanes.h"

#include "fem/lane_element.h"

/// Modes with negative eigenvalues that scalar code found for a projected tangent: per lane `count` modes,
/// each of ten numbers, the deficit and the mode.
struct ProjectedModes {
  int count[kWidth];
  double mode[kWidth][90];
};

/// Returns the lanes where the exact tangent is positive definite, so that it equals the projected one. In
/// the basis of the singular vectors twists and flips have the eigenvalues a +- d s_k, which are all positive
/// if a^2 1 - d^2 F F^T is positive definite. The stretches have the matrix A; its invariants are symmetric
/// functions of the singular values and so polynomials of I = |F|^2, II = |cof F|^2 and J. With e = l J + d,
/// A_ij = b s_i s_j + e s_k for i != j, and N = A - b s s^T with the diagonal n_i = a + l c_i^2,
///
///   sum of the minors = 3 a^2 + 2 a (b I + l II) + l^2 J^2 I + b l (I II - 3 J^2) - 6 b e J - e^2 I,
///   det A = det N + b s^T adj(N) s,
///   det N = a^3 + a^2 l II + a l^2 J^2 I + l^3 J^4 + 2 e^3 J - e^2 (a I + 3 l J^2),
///   s^T adj(N) s = a^2 I + a l (I II - 3 J^2) + l^2 J^2 (I^2 - 2 II) - e^2 (I^2 - 4 II)
///                  - 2 e J (3 a + l II).
///
/// Where these are within rounding of zero, the lane is left to the eigenvalues.
PALPATE_INLINE Mask surely_definite(Pack a, Pack b, Pack d, double l, const Matrix& F, const Matrix& cof,
                                    Pack I, Pack J) {
  const Symmetric B = gram_of_rows(F);
  const Pack d2 = d * d, a2 = a * a;
  const Pack x = a2 - d2 * B.xx, y = a2 - d2 * B.yy, z = a2 - d2 * B.zz;
  const Pack yz = d2 * B.yz, xz = d2 * B.xz, xy = d2 * B.xy;  // minus the off-diagonal entries
  const Pack minor = x * y - xy * xy;
  Mask out = (a > 0.0) & (x > 0.0) & (minor > 0.0) &
             (z * minor - x * yz * yz - y * xz * xz - 2.0 * xy * yz * xz > 0.0);
  const Pack II = double_dot(cof, cof), J2 = J * J, e = l * J + d, e2 = e * e, mixed = I * II - 3.0 * J2;
  const Pack trace = 3.0 * a + b * I + l * II;
  const Pack minors =
      3.0 * a2 + 2.0 * a * (b * I + l * II) + l * l * J2 * I + b * l * mixed - 6.0 * b * e * J - e2 * I;
  const Pack det_N = a2 * (a + l * II) + a * (l * l) * J2 * I + l * l * l * J2 * J2 + 2.0 * e2 * e * J -
                     e2 * (a * I + 3.0 * l * J2);
  const Pack adjugate = a2 * I + a * l * mixed + l * l * J2 * (I * I - 2.0 * II) - e2 * (I * I - 4.0 * II) -
                        2.0 * e * J * (3.0 * a + l * II);
  constexpr double kRounding = 1e-11;
  out &= (minors > kRounding * trace * trace) & (det_N + b * adjugate > kRounding * trace * trace * trace);
  return out;
}

[[gnu::noinline, gnu::cold]] static void find_modes(const ElementModel& model, const Matrix* F,
                                                    const Mask* right, const ScalarPath& scalar,
                                                    ProjectedModes& modes, LaneCounts& counts) {
  for (int l = 0; l < kWidth; ++l) {
    modes.count[l] = 0;
    if ((*right)[l] != 0) continue;
    double one_F[9];
    take_lane(*F, l, one_F);
    modes.count[l] = scalar.tangent(model, one_F, nullptr, modes.mode[l]);
    ++counts.by_scalar;
  }
}

/// dP += sum of deficit (M : dF) M
[[gnu::noinline, gnu::cold]] static void add_change(const ProjectedModes& modes, const Matrix* dF,
                                                    Matrix* dP) {
  for (int l = 0; l < kWidth; ++l) {
    double direction[9], change[9];
    take_lane(*dF, l, direction);
    take_lane(*dP, l, change);
    for (int i = 0; i < modes.count[l]; ++i) {
      const double *mode = modes.mode[l] + 10 * i, *M = mode + 1;
      double along = 0.0;
      for (int k = 0; k < 9; ++k) along += M[k] * direction[k];
      for (int k = 0; k < 9; ++k) change[k] += mode[0] * along * M[k];
    }
    put_lane(change, l, *dP);
  }
}

/// K_ab += V k_scale sum of deficit (M g_a) (M g_b)^T
[[gnu::noinline, gnu::cold]] static void add_blocks(const ProjectedModes& modes, const GroupEdges& edges,
                                                    const Lanes& at, double k_scale, const ChunkBlocks& upper,
                                                    const ChunkBlocks* lower) {
  constexpr int kEnds[6][2] = {{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}};
  for (int l = 0; l < kWidth; ++l) {
    const int lane = at.first + l;
    double g[6];
    for (int k = 0; k < 6; ++k) g[k] = at.group.inverse_edges[k][lane];
    for (int i = 0; i < modes.count[l]; ++i) {
      const double *mode = modes.mode[l] + 10 * i, *M = mode + 1;
      const double scale = k_scale * at.group.volume[lane] * mode[0];
      double v[4][3];
      for (int r = 0; r < 3; ++r) {
        v[1][r] = M[3 * r] * g[0] + M[3 * r + 1] * g[1] + M[3 * r + 2] * g[2];
        v[2][r] = M[3 * r + 1] * g[3] + M[3 * r + 2] * g[4];
        v[3][r] = M[3 * r + 2] * g[5];
        v[0][r] = -(v[1][r] + v[2][r] + v[3][r]);
      }
      for (int k = 0; k < 6; ++k) {
        const double *a = v[kEnds[k][0]], *b = v[kEnds[k][1]];
        const auto edge = index_of(edges.edge[k][lane]);
        const auto add = [&](const ChunkBlocks& blocks, const double* row, const double* column) {
          for (std::size_t c = 0; c < 8; ++c)
            blocks.first[8 * edge + c] += scale * row[c / 3] * column[c % 3];
          blocks.last[edge] += scale * row[2] * column[2];
        };
        add(upper, a, b);
        if (lower) add(*lower, b, a);
      }
    }
  }
}

struct StableNeoHookean {
  static constexpr bool kHasWarped = false;

  struct State {
    Matrix cof;
    Pack det, norm, inverse;  ///< J, I, 1/(I + 1)
  };
  PALPATE_INLINE void find_states(const Matrix* F, int, const ScalarPath&, State* states, LaneCounts&) {
    for (int n = 0; n < kTogether; ++n) {
      State& state = states[n];
      state.cof = cofactors(F[n]);
      state.det = dot(F[n].row[0], state.cof.row[0]);
      state.norm = double_dot(F[n], F[n]);
      state.inverse = 1.0 / (state.norm + 1.0);
    }
  }

  PALPATE_INLINE double own_mu(const ElementModel& model) { return 4.0 / 3.0 * model.mu; }
  PALPATE_INLINE double own_lambda(const ElementModel& model) { return model.lambda + 5.0 / 6.0 * model.mu; }

  struct Tangent {
    Pack a, b, d;
    const ProjectedModes* modes;  ///< null if no lane has any
  };
  using ScalarModes = ProjectedModes;

  PALPATE_INLINE Tangent coefficients(const ElementModel& model, const State& state) {
    const double m = own_mu(model);
    const Pack share = m * state.inverse;
    return {m - share, 2.0 * share * state.inverse, own_lambda(model) * (state.det - 1.0) - 0.75 * m,
            nullptr};
  }

  PALPATE_INLINE Matrix stress(const ElementModel& model, const Matrix& F, const State& state) {
    const Tangent at = coefficients(model, state);
    return at.a * F + at.d * state.cof;
  }

  PALPATE_INLINE Pack energy_density(const ElementModel& model, const Matrix&, const State& state) {
    const double m = own_mu(model);
    const Pack excess = state.norm - 3.0, growth = state.det - 1.0;
    Pack logarithm;
    for (int l = 0; l < kWidth; ++l) logarithm[l] = __builtin_log1p(0.25 * excess[l]);
    return 0.5 * m * (excess - logarithm) - 0.75 * m * growth + 0.5 * own_lambda(model) * growth * growth;
  }

  PALPATE_INLINE Tangent tangent(const ElementModel& model, const Matrix& F, const State& state,
                                 const ScalarPath& scalar, ScalarModes& modes, LaneCounts& counts) {
    Tangent out = coefficients(model, state);
    if (model.projected) {
      const Mask right =
          surely_definite(out.a, out.b, out.d, own_lambda(model), F, state.cof, state.norm, state.det);
      if (any(~right)) {
        const Matrix copy_F = F;
        const Mask copy_right = right;
        find_modes(model, &copy_F, &copy_right, scalar, modes, counts);
        out.modes = &modes;
      }
    }
    return out;
  }

  PALPATE_INLINE Matrix change(const ElementModel& model, const Matrix& F, const State& state,
                               const Tangent& at, const Matrix& dF) {
    const Matrix& G = state.cof;
    const Pack along_F = at.b * double_dot(F, dF), along_G = own_lambda(model) * double_dot(G, dF);
    const Matrix dG{{cross(dF.row[1], F.row[2]) + cross(F.row[1], dF.row[2]),
                     cross(dF.row[2], F.row[0]) + cross(F.row[2], dF.row[0]),
                     cross(dF.row[0], F.row[1]) + cross(F.row[0], dF.row[1])}};
    Matrix dP = at.a * dF + along_F * F + along_G * G + at.d * dG;
    if (at.modes) [[unlikely]] {
      const Matrix copy_dF = dF;
      Matrix copy_dP = dP;
      add_change(*at.modes, &copy_dF, &copy_dP);
      dP = copy_dP;
    }
    return dP;
  }

  struct BlockParts {
    Pack a;
    Vector k[4], bk[4], n[4], ln[4];  ///< F g_a, G g_a, and both times their scaled constants
    Vector q[4][4];                   ///< -d F (g_a x g_b), scaled, for a < b
  };
  template <bool kWarped>
  PALPATE_INLINE void set_parts(BlockParts& e, const ElementModel& model, const Matrix& F, const State& state,
                                const Tangent& at, const Gradients& G, Pack volume) {
    const Pack scale = model.k_scale * volume;
    e.a = at.a * scale;
    spread(F, G, e.k);
    spread(state.cof, G, e.n);
    const Pack b = at.b * scale, l = own_lambda(model) * scale, d = -(at.d * scale);
    for (int a = 0; a < 3; ++a) {  // the edge's second node needs no constant
      e.bk[a] = b * e.k[a];
      e.ln[a] = l * e.n[a];
    }
    // g_1 x g_2, g_2 x g_3, g_3 x g_1 entry by entry; g_0 = -(g_1 + g_2 + g_3) yields the others.
    const Vector x{F.row[0].x, F.row[1].x, F.row[2].x}, y{F.row[0].y, F.row[1].y, F.row[2].y},
        z{F.row[0].z, F.row[1].z, F.row[2].z};
    const Vector q12 =
        (d * (G.xy * G.yz - G.xz * G.yy)) * x - (d * (G.xx * G.yz)) * y + (d * (G.xx * G.yy)) * z;
    const Vector q23 = (d * (G.yy * G.zz)) * x, q31 = (d * (G.xx * G.zz)) * y - (d * (G.xy * G.zz)) * x;
    e.q[1][2] = q12;
    e.q[2][3] = q23;
    e.q[1][3] = -q31;
    e.q[0][1] = q12 - q31;
    e.q[0][2] = q23 - q12;
    e.q[0][3] = q31 - q23;
  }

  /// a (g_a . g_b) 1 + b k_a k_b^T + l n_a n_b^T + [q_ab]x
  template <bool kWarped>
  PALPATE_INLINE Matrix block(const BlockParts& e, Pack gg, int a, int b) {
    const Vector &k = e.bk[a], &q = e.q[a][b];
    Matrix block{{k.x * e.k[b], k.y * e.k[b], k.z * e.k[b]}};
    add_outer(block, e.ln[a], e.n[b]);
    add_diagonal(block, e.a * gg);
    block.row[0].y -= q.z;
    block.row[0].z += q.y;
    block.row[1].x += q.z;
    block.row[1].z -= q.x;
    block.row[2].x -= q.y;
    block.row[2].y += q.x;
    return block;
  }

  PALPATE_INLINE void add_modes(const Tangent& at, const GroupEdges& edges, const Lanes& lanes,
                                double k_scale, const ChunkBlocks& upper, const ChunkBlocks* lower) {
    if (at.modes) [[unlikely]]
      add_blocks(*at.modes, edges, lanes, k_scale, upper, lower);
  }
};

#include "fem/lane_forces.h"

#include "fem/lane_deferred.h"

#include "fem/lane_blocks.h"

}  // namespace

extern const LawKernels stable_neo_hookean;
const LawKernels stable_neo_hookean = kernels_of<StableNeoHookean>;

}  // namespace palpate::fem::PALPATE_KERNELS
