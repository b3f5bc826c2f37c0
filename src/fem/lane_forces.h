#pragma once
// Force, energy and the product with the tangent for any law, eight elements at a time. A law is a struct of
// static functions on vectors of elements:
//
//   State                                quantities of F that forces and tangents need; member det = det F
//   find_states(F, count, scalar, state, counts)         the first `count` of kTogether elements
//   stress(model, F, state)              first Piola-Kirchhoff stress P
//   energy_density(model, F, state)
//   Tangent, ScalarModes                 dP/dF of one of the tangents; memory for lanes that scalar code
//                                        computed, empty where there is none
//   tangent(model, F, state, scalar, modes, counts)
//   change(model, F, state, tangent, dF)                 dP
//   BlockParts                           common factors of the element matrix's blocks, scaled
//   set_parts<kWarped>(parts, model, F, state, tangent, G, volume)
//   block<kWarped>(parts, g_a . g_b, a, b)               K_ab, a < b
//   add_modes(tangent, edges, at, scale, upper, lower)   scalar code's additions to the blocks
//   kHasWarped                           whether kWarped is ever requested

template <class Law>
using State = typename Law::State;

/// Calls work(lanes, F, state) for each element of the groups, with the law's state of F.
template <class Law, class Work>
PALPATE_INLINE void for_each_element(const ElementGroup* groups, int count, const ChunkFields& fields,
                                     const ScalarPath& scalar, LaneCounts& counts, Work&& work) {
  for (int g = 0; g < count; g += kTogether) {
    const int here = count - g < kTogether ? count - g : kTogether;
    for (int part = 0; part < 8; part += kWidth) {
      Matrix F[kTogether];
      typename Law::State state[kTogether];
      for (int n = 0; n < kTogether; ++n) {
        if (part == 0) fetch_ahead(groups, g + n, 0, 2);
        const Lanes at{groups[g + (n < here ? n : 0)], part, g + n};
        F[n] = gradient_of(at, gradients(at), fields.x);
      }
      Law::find_states(F, here, scalar, state, counts);
#pragma GCC unroll 1
      for (int n = 0; n < here; ++n) {
        if (part == 0) {
          fetch_ahead(groups, g + n, 1, 2);
          if (fields.next_nodes) fetch_nodes(*fields.next_nodes);
        }
        work(Lanes{groups[g + n], part, g + n}, F[n], state[n]);
      }
    }
  }
}

PALPATE_INLINE Pack square_root(Pack x) {
  for (int l = 0; l < kWidth; ++l) x[l] = __builtin_sqrt(x[l]);
  return x;
}

/// Adds V/4 times the von Mises norm of the Cauchy stress (stress.h) to the x-coordinates of the nodes.
template <class Law>
static void von_mises(const ElementGroup* groups, int count, const ElementModel& model,
                      const ScalarPath& scalar, const ChunkFields& fields, double* f, LaneCounts& counts) {
  for_each_element<Law>(
      groups, count, fields, scalar,
      counts, [&](const Lanes& at, const Matrix& F, const State<Law>& state) __attribute__((always_inline)) {
        const Matrix PFt = times_transposed(Law::stress(model, F, state), F);
        const Pack mean = (PFt.row[0].x + PFt.row[1].y + PFt.row[2].z) / 3.0, zero{};
        const Pack det = state.det < kSmallestStressDet ? zero + kSmallestStressDet : state.det;
        const Matrix deviator = PFt - Matrix{{{mean, zero, zero}, {zero, mean, zero}, {zero, zero, mean}}};
        const Pack norm = square_root(1.5 * double_dot(deviator, deviator)) / det;
        const Vector share{0.25 * at.volume() * norm, zero, zero};
        for (int a = 0; a < 4; ++a) scatter_add(f, at.node(a), share);
      });
}

template <class Law, bool kDamped>
static void forces(const ElementGroup* groups, int count, const ElementModel& model, const ScalarPath& scalar,
                   const ChunkFields& fields, double* f, LaneCounts& counts) {
  for_each_element<Law>(
      groups, count, fields, scalar,
      counts, [&](const Lanes& at, const Matrix& F, const State<Law>& state) __attribute__((always_inline)) {
        const Gradients G = gradients(at);
        count_inverted(state.det, counts);
        Matrix P = Law::stress(model, F, state);
        if constexpr (kDamped)
          P = P + F * full(damping_stress(symmetric_product(F, gradient_of(at, G, fields.v)), model));
        add_forces(at, G, P, -at.volume(), f);
      });
}

template <class Law>
static void force(const ElementGroup* groups, int count, const ElementModel& model, const ScalarPath& scalar,
                  const ChunkFields& fields, double* f, LaneCounts& counts) {
  if (model.damping_mu > 0.0)
    forces<Law, true>(groups, count, model, scalar, fields, f, counts);
  else
    forces<Law, false>(groups, count, model, scalar, fields, f, counts);
}

template <class Law>
static void energy(const ElementGroup* groups, int count, const ElementModel& model, const ScalarPath& scalar,
                   const ChunkFields& fields, double sums[8], LaneCounts& counts) {
  for_each_element<Law>(
      groups, count, fields, scalar,
      counts, [&](const Lanes& at, const Matrix& F, const State<Law>& state) __attribute__((always_inline)) {
        const Pack density = Law::energy_density(model, F, state);
        *reinterpret_cast<PackInMemory*>(sums + at.first) += at.volume() * density;
      });
}

/// Damping of a step: kOfChange is damping at the velocity d_scale w.
enum class Damping { kNone, kOfVelocity, kOfChange };

/// Returns the stress of a linearly implicit step: the stress of the state, its elastic change by w, and the
/// damping stress at the velocity. The stress of the state is rounded alone: iterations evaluate this for
/// ever smaller changes of w, whose sum with it would lose them.
template <class Law, Damping kDamping>
PALPATE_INLINE Matrix step_stress(const Lanes& at, const Gradients& G, const Matrix& F,
                                  const State<Law>& state, const typename Law::Tangent& tangent,
                                  const ElementModel& model, const ChunkFields& fields) {
  const Matrix dF = gradient_of(at, G, fields.w);
  const Matrix P = Law::stress(model, F, state) + Law::change(model, F, state, tangent, dF);
  if constexpr (kDamping == Damping::kNone) return P;
  if constexpr (kDamping == Damping::kOfVelocity)
    return P + F * full(damping_stress(symmetric_product(F, gradient_of(at, G, fields.v)), model));
  ElementModel scaled = model;
  scaled.damping_mu *= model.d_scale;
  scaled.damping_lambda *= model.d_scale;
  return P + F * full(damping_stress(symmetric_product(F, dF), scaled));
}

template <class Law, Damping kDamping>
static void step_forces(const ElementGroup* groups, int count, const ElementModel& model,
                        const ScalarPath& scalar, const ChunkFields& fields, double* f, LaneCounts& counts) {
  for_each_element<Law>(
      groups, count, fields, scalar,
      counts, [&](const Lanes& at, const Matrix& F, const State<Law>& state) __attribute__((always_inline)) {
        const Gradients G = gradients(at);
        count_inverted(state.det, counts);
        typename Law::ScalarModes modes;
        const typename Law::Tangent tangent = Law::tangent(model, F, state, scalar, modes, counts);
        add_forces(at, G, step_stress<Law, kDamping>(at, G, F, state, tangent, model, fields), -at.volume(),
                   f);
      });
}

template <class Law>
static void step_force(const ElementGroup* groups, int count, const ElementModel& model,
                       const ScalarPath& scalar, const ChunkFields& fields, double* f, LaneCounts& counts) {
  if (model.damping_mu == 0.0)
    step_forces<Law, Damping::kNone>(groups, count, model, scalar, fields, f, counts);
  else if (fields.v)
    step_forces<Law, Damping::kOfVelocity>(groups, count, model, scalar, fields, f, counts);
  else
    step_forces<Law, Damping::kOfChange>(groups, count, model, scalar, fields, f, counts);
}

template <class Law>
static void apply_tangent(const ElementGroup* groups, int count, const ElementModel& model,
                          const ScalarPath& scalar, const ChunkFields& fields, double* y,
                          LaneCounts& counts) {
  const bool damped = model.damping_mu > 0.0 && model.d_scale != 0.0;
  const auto damping = [&](const Matrix& F, const Matrix& dF) __attribute__((always_inline)) {
    return (Pack{} + model.d_scale) * (F * full(damping_stress(symmetric_product(F, dF), model)));
  };
  if (model.k_scale == 0.0) {
    for (int g = 0; g < count; ++g) {
      fetch_ahead(groups, g);
      for (int part = 0; part < 8; part += kWidth) {
        const Lanes at{groups[g], part, g};
        const Gradients G = gradients(at);
        if (damped)
          add_forces(at, G, damping(gradient_of(at, G, fields.x), gradient_of(at, G, fields.w)), at.volume(),
                     y);
      }
    }
    return;
  }
  for_each_element<Law>(
      groups, count, fields, scalar,
      counts, [&](const Lanes& at, const Matrix& F, const State<Law>& state) __attribute__((always_inline)) {
        const Gradients G = gradients(at);
        const Matrix dF = gradient_of(at, G, fields.w);
        typename Law::ScalarModes modes;
        Matrix dP = Law::change(model, F, state, Law::tangent(model, F, state, scalar, modes, counts), dF);
        if (model.by_position) {
          const Matrix F_dot = gradient_of(at, G, fields.v);
          dP = dP + dF * full(damping_stress(symmetric_product(F, F_dot), model)) +
               F * full(damping_stress(symmetric_product(dF, F_dot), model));
        }
        dP = (Pack{} + model.k_scale) * dP;
        if (damped) dP = dP + damping(F, dF);
        add_forces(at, G, dP, at.volume(), y);
      });
}
