// Corotational law in SIMD lanes; derivation and scalar formulas: corotational.h.
#ifdef __AVX2__
#include <immintrin.h>
#endif

#include "fem/lane_kernels.h"

namespace palpate::fem::PALPATE_KERNELS {
namespace {

#include "fem/lanes.h"

#include "fem/lane_element.h"

#include "fem/lane_rotation.h"

// Coupling matrix C of a tangent. A = tr(B) I - B is inverted by its cofactors where det A > kSmallestSum (tr
// A / 2)^2, as in corotational.cpp.

/// Computes C [Pa]; returns the lanes where it is accurate.
PALPATE_INLINE Mask find_coupling(const ElementModel& model, const Matrix& F, const Matrix& R, Symmetric& C) {
  constexpr double kSmallestSum = 1e-4;  // corotational.h
  const Pack xx = dot(F.row[0], R.row[0]), yy = dot(F.row[1], R.row[1]), zz = dot(F.row[2], R.row[2]);
  const Symmetric A{yy + zz,
                    xx + zz,
                    xx + yy,
                    -0.5 * (dot(F.row[1], R.row[2]) + dot(F.row[2], R.row[1])),
                    -0.5 * (dot(F.row[0], R.row[2]) + dot(F.row[2], R.row[0])),
                    -0.5 * (dot(F.row[0], R.row[1]) + dot(F.row[1], R.row[0]))};
  const Pack trace = xx + yy + zz, c = 2.0 * model.mu - model.lambda * (trace - 3.0);
  const Symmetric cof{A.yy * A.zz - A.yz * A.yz, A.xx * A.zz - A.xz * A.xz, A.xx * A.yy - A.xy * A.xy,
                      A.xy * A.xz - A.xx * A.yz, A.xy * A.yz - A.yy * A.xz, A.xz * A.yz - A.zz * A.xy};
  const Pack det = A.xx * cof.xx + A.xy * cof.xy + A.xz * cof.xz;
  const Pack s = c / det;
  C = {s * cof.xx, s * cof.yy, s * cof.zz, s * cof.yz, s * cof.xz, s * cof.xy};
  Mask right = det > kSmallestSum * trace * trace;
  if (model.projected) {  // mu A - c I positive definite (Sylvester): the bound mu is inactive
    const Pack a = model.mu * A.xx - c, b = model.mu * A.yy - c, d = model.mu * A.zz - c;
    const Pack yz = model.mu * A.yz, xz = model.mu * A.xz, xy = model.mu * A.xy;
    const Pack minor = a * b - xy * xy;
    right &= (a > 0.0) & (minor > 0.0) & (d * minor - a * yz * yz - b * xz * xz + 2.0 * xy * yz * xz > 0.0);
  }
  return right;
}

[[gnu::noinline, gnu::cold]] static void couple_by_scalar(const ElementModel& model, const Matrix* F,
                                                          const Matrix* R, Matrix* C, const Mask* right,
                                                          const ScalarPath& scalar, LaneCounts& counts) {
  for (int l = 0; l < kWidth; ++l) {
    if ((*right)[l] != 0) continue;
    double one_F[9], one_R[9], one_C[9];
    take_lane(*F, l, one_F);
    take_lane(*R, l, one_R);
    if (scalar.tangent(model, one_F, one_R, one_C) != 0) ++counts.clamped;
    put_lane(one_C, l, *C);
    ++counts.by_scalar;
  }
}

struct Corotational {
  static constexpr bool kHasWarped = true;

  struct State {
    Matrix R;
    Pack det;
  };
  PALPATE_INLINE void find_states(const Matrix* F, int count, const ScalarPath& scalar, State* states,
                                  LaneCounts& counts) {
    rotations(F, count, scalar, states, counts);
  }

  /// 2 mu (F - R) + lambda (tr(R^T F) - 3) R
  PALPATE_INLINE Matrix stress(const ElementModel& model, const Matrix& F, const State& state) {
    const double mu2 = 2.0 * model.mu;
    return (Pack{} + mu2) * F + (model.lambda * (double_dot(state.R, F) - 3.0) - mu2) * state.R;
  }

  PALPATE_INLINE Pack energy_density(const ElementModel& model, const Matrix& F, const State& state) {
    const Matrix strain = F - state.R;
    const Pack trace = double_dot(state.R, F) - 3.0;
    return model.mu * double_dot(strain, strain) + (0.5 * model.lambda) * trace * trace;
  }

  struct Tangent {
    Symmetric C;
  };
  struct ScalarModes {};
  PALPATE_INLINE Tangent tangent(const ElementModel& model, const Matrix& F, const State& state,
                                 const ScalarPath& scalar, ScalarModes&, LaneCounts& counts) {
    if (model.warped) {
      const Pack zero{}, mu = zero + model.mu;
      return {{mu, mu, mu, zero, zero, zero}};
    }
    Symmetric C;
    const Mask right = find_coupling(model, F, state.R, C);
    if (any(~right)) [[unlikely]] {
      Matrix copy_F = F, copy_R = state.R, copy_C = full(C);
      Mask copy_right = right;
      couple_by_scalar(model, &copy_F, &copy_R, &copy_C, &copy_right, scalar, counts);
      C = {copy_C.row[0].x, copy_C.row[1].y, copy_C.row[2].z,
           copy_C.row[1].z, copy_C.row[0].z, copy_C.row[0].y};
    }
    return {C};
  }

  /// 2 mu dF + lambda tr(M) R - [w]x R, row by row, with M = dF R^T and w = C axial(M).
  PALPATE_INLINE Matrix change(const ElementModel& model, const Matrix&, const State& state,
                               const Tangent& tangent, const Matrix& dF) {
    const Matrix& R = state.R;
    const Matrix M = times_transposed(dF, R);
    const Vector w =
        apply(full(tangent.C), {M.row[2].y - M.row[1].z, M.row[0].z - M.row[2].x, M.row[1].x - M.row[0].y});
    const Pack stretch = model.lambda * (M.row[0].x + M.row[1].y + M.row[2].z), mu2 = Pack{} + 2.0 * model.mu;
    return {{mu2 * dF.row[0] + (stretch * R.row[0] + w.z * R.row[1] - w.y * R.row[2]),
             mu2 * dF.row[1] + (stretch * R.row[1] - w.z * R.row[0] + w.x * R.row[2]),
             mu2 * dF.row[2] + (stretch * R.row[2] + w.y * R.row[0] - w.x * R.row[1])}};
  }

  struct BlockParts {
    Vector h[4];       ///< R g_a; their sum is zero
    Matrix hC[3];      ///< [h_a]x C, scaled
    Pack mu2, lambda;  ///< 2 mu, lambda, scaled
  };
  template <bool kWarped>
  PALPATE_INLINE void set_parts(BlockParts& e, const ElementModel& model, const Matrix&, const State& state,
                                const Tangent& tangent, const Gradients& G, Pack volume) {
    const Pack k = model.k_scale * volume;
    e.mu2 = (2.0 * model.mu) * k;
    e.lambda = model.lambda * k;
    spread(state.R, G, e.h);
    if constexpr (kWarped) return;
    const Matrix kC = k * full(tangent.C);
    for (int a = 0; a < 3; ++a) {
      const Vector& h = e.h[a];
      e.hC[a] = {{h.y * kC.row[2] - h.z * kC.row[1], h.z * kC.row[0] - h.x * kC.row[2],
                  h.x * kC.row[1] - h.y * kC.row[0]}};
    }
  }

  /// lambda h_a h_b^T + [h_a]x C [h_b]x + 2 mu (g_a . g_b) I, where a row m^T of [h_a]x C yields (m x h_b)^T;
  /// with C = mu I: lambda h_a h_b^T + mu h_b h_a^T + mu (g_a . g_b) I.
  template <bool kWarped>
  PALPATE_INLINE Matrix block(const BlockParts& e, Pack gg, int a, int b) {
    if constexpr (kWarped) {
      const Vector p = e.lambda * e.h[a], q = (0.5 * e.mu2) * e.h[a];
      Matrix block{{p.x * e.h[b], p.y * e.h[b], p.z * e.h[b]}};
      add_outer(block, e.h[b], q);
      add_diagonal(block, (0.5 * e.mu2) * gg);
      return block;
    }
    Matrix block;
    for (int r = 0; r < 3; ++r) block.row[r] = cross(e.hC[a].row[r], e.h[b]);
    add_outer(block, e.lambda * e.h[a], e.h[b]);
    add_diagonal(block, e.mu2 * gg);
    return block;
  }

  PALPATE_INLINE void add_modes(const Tangent&, const GroupEdges&, const Lanes&, double, const ChunkBlocks&,
                                const ChunkBlocks*) {}
};

#include "fem/lane_forces.h"

#include "fem/lane_deferred.h"

#include "fem/lane_blocks.h"

}  // namespace

extern const LawKernels corotational;
const LawKernels corotational = kernels_of<Corotational>;

}  // namespace palpate::fem::PALPATE_KERNELS
