#pragma once
// Force, energy and the product with the tangent, eight elements at a time.  The formulas are those of
// corotated.h.

/// Work on one group takes some 120 ns, a line from memory about as long: well ahead, and into the
/// second-level cache.
constexpr int kGroupsAhead = 16;
/// Asks for share number `share` of the lines of what comes kGroupsAhead records later.  A core has some
/// sixteen lines on their way at a time: asked for all at once they hold up what the work itself wants from
/// the second-level cache, so that a record of many lines is asked for in several places.
template <class Record>
PALPATE_INLINE void fetch_ahead(const Record* records, int g, int share = 0, int shares = 1) {
  constexpr int kLines = (sizeof(Record) + 63) / 64;
  // behind the last one stand those of the next run, or nothing that hurts
  const char* first = reinterpret_cast<const char*>(records + g + kGroupsAhead);
  for (int line = share * kLines / shares; line < (share + 1) * kLines / shares; ++line)
    __builtin_prefetch(first + 64 * line, 0, 2);
}

PALPATE_INLINE void fetch_nodes(ComingNodes& coming) {
  const int end =
      coming.count - coming.asked < coming.at_a_time ? coming.count : coming.asked + coming.at_a_time;
  for (int k = coming.asked; k < end; ++k)
    for (int f = 0; f < coming.field_count; ++f)
      fetch<2>(coming.fields[f] + 3 * static_cast<std::int64_t>(coming.nodes[k]), 24);
  coming.asked = end;
}

/// A few lines of the rows to come, asked for with each edge of a group: all that a chunk writes, or most of
/// it, is then on its way while there is arithmetic to do.
PALPATE_INLINE void fetch_rows(ComingRows& rows) {
  constexpr int kLines = 5;
  if (rows.next >= rows.end) {
    if (rows.asked == rows.count) return;
    const int node = rows.nodes[rows.asked++];
    rows.next =
        reinterpret_cast<const char*>(rows.values + 9 * static_cast<std::int64_t>(rows.row_start[node]));
    rows.end =
        reinterpret_cast<const char*>(rows.values + 9 * static_cast<std::int64_t>(rows.row_start[node + 1]));
  }
  fetch<2>(rows.next, 64 * kLines);
  rows.next += 64 * kLines;
}

/// The lanes of group number g of a run from `first` on.
struct Lanes {
  const ElementGroup& group;
  int first, number;
  Pack inverse_edges(int entry) const { return load(group.inverse_edges[entry] + first); }
  Pack volume() const { return load(group.volume + first); }
  const std::uint16_t* node(int corner) const { return group.node[corner] + first; }
};

/// Rows g_1, g_2, g_3 of an upper triangle.
struct Gradients {
  Pack xx, xy, xz, yy, yz, zz;
};
PALPATE_INLINE Gradients gradients(const Lanes& at) {
  return {at.inverse_edges(0), at.inverse_edges(1), at.inverse_edges(2),
          at.inverse_edges(3), at.inverse_edges(4), at.inverse_edges(5)};
}
/// M g_0 to M g_3, where g_0 is minus the sum of the others.
PALPATE_INLINE void spread(const Matrix& M, const Gradients& G, Vector* v) {
  const Vector x{M.row[0].x, M.row[1].x, M.row[2].x}, y{M.row[0].y, M.row[1].y, M.row[2].y},
      z{M.row[0].z, M.row[1].z, M.row[2].z};
  v[1] = G.xx * x + G.xy * y + G.xz * z;
  v[2] = G.yy * y + G.yz * z;
  v[3] = G.zz * z;
  v[0] = -(v[1] + v[2] + v[3]);
}

/// Ds T^-1 of a nodal field: its gradient by the rest position.
PALPATE_INLINE Matrix gradient_of(const Lanes& at, const Gradients& G, const double* field) {
  const Vector origin = gather(field, at.node(0));
  const Vector a = gather(field, at.node(1)) - origin, b = gather(field, at.node(2)) - origin,
               c = gather(field, at.node(3)) - origin;
  const Vector x = G.xx * a, y = G.xy * a + G.yy * b, z = G.xz * a + G.yz * b + G.zz * c;
  return {{{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}};
}

/// work(lanes, F, R, det F) for each element of the groups.
template <class Work>
PALPATE_INLINE void for_each_rotated(const ElementGroup* groups, int count, const ChunkFields& fields,
                                     const ScalarPath& scalar, LaneCounts& counts, Work&& work) {
  for (int g = 0; g < count; g += kTogether) {
    const int here = count - g < kTogether ? count - g : kTogether;
    for (int part = 0; part < 8; part += kWidth) {
      Matrix F[kTogether], R[kTogether];
      Pack det[kTogether];
      for (int n = 0; n < kTogether; ++n) {
        if (part == 0) fetch_ahead(groups, g + n, 0, 2);
        const Lanes at{groups[g + (n < here ? n : 0)], part, g + n};
        F[n] = gradient_of(at, gradients(at), fields.x);
      }
      rotations(F, here, scalar, R, det, counts);
#pragma GCC unroll 1
      for (int n = 0; n < here; ++n) {
        if (part == 0) {
          fetch_ahead(groups, g + n, 1, 2);
          if (fields.coming) fetch_nodes(*fields.coming);
        }
        work(Lanes{groups[g + n], part, g + n}, F[n], R[n], det[n]);
      }
    }
  }
}

/// f_a += scale P g_a
PALPATE_INLINE void add_forces(const Lanes& at, const Gradients& G, const Matrix& P, Pack scale, double* f) {
  Vector share[4];
  spread(scale * P, G, share);
  for (int a = 0; a < 4; ++a) scatter_add(f, at.node(a), share[a]);
}

/// sym(A^T B)
PALPATE_INLINE Symmetric symmetric_product(const Matrix& A, const Matrix& B) {
  const auto columns = [](const Matrix& M) {
    return Matrix{{{M.row[0].x, M.row[1].x, M.row[2].x},
                   {M.row[0].y, M.row[1].y, M.row[2].y},
                   {M.row[0].z, M.row[1].z, M.row[2].z}}};
  };
  const Matrix a = columns(A), b = columns(B);
  return {dot(a.row[0], b.row[0]),
          dot(a.row[1], b.row[1]),
          dot(a.row[2], b.row[2]),
          0.5 * (dot(a.row[1], b.row[2]) + dot(a.row[2], b.row[1])),
          0.5 * (dot(a.row[0], b.row[2]) + dot(a.row[2], b.row[0])),
          0.5 * (dot(a.row[0], b.row[1]) + dot(a.row[1], b.row[0]))};
}

/// 2 mu_d E' + lambda_d tr(E') I
PALPATE_INLINE Symmetric damping_stress(const Symmetric& rate, const ElementModel& model) {
  const double mu2 = 2.0 * model.damping_mu;
  const Pack trace = model.damping_lambda * (rate.xx + rate.yy + rate.zz);
  return {mu2 * rate.xx + trace, mu2 * rate.yy + trace, mu2 * rate.zz + trace,
          mu2 * rate.yz,         mu2 * rate.xz,         mu2 * rate.xy};
}

PALPATE_INLINE long count_of(Mask m) {
  long sum = 0;
  for (int l = 0; l < kWidth; ++l) sum -= static_cast<long>(m[l]);
  return sum;
}

PALPATE_INLINE void count_inverted(Pack det, LaneCounts& counts) {
  const Mask inverted = det <= 0.0;
  if (any(inverted)) counts.inverted += count_of(inverted);
}

/// 2 mu (F - R) + lambda (tr(R^T F) - 3) R
PALPATE_INLINE Matrix elastic_stress(const ElementModel& model, const Matrix& F, const Matrix& R) {
  const double mu2 = 2.0 * model.mu;
  return (Pack{} + mu2) * F + (model.lambda * (double_dot(R, F) - 3.0) - mu2) * R;
}

template <bool kDamped>
static void forces(const ElementGroup* groups, int count, const ElementModel& model, const ScalarPath& scalar,
                   const ChunkFields& fields, double* f, LaneCounts& counts) {
  for_each_rotated(
      groups, count, fields, scalar, counts,
      [&](const Lanes& at, const Matrix& F, const Matrix& R, const Pack& det) __attribute__((always_inline)) {
        const Gradients G = gradients(at);
        count_inverted(det, counts);
        Matrix P = elastic_stress(model, F, R);
        if constexpr (kDamped)
          P = P + F * full(damping_stress(symmetric_product(F, gradient_of(at, G, fields.v)), model));
        add_forces(at, G, P, -at.volume(), f);
      });
}

static void force(const ElementGroup* groups, int count, const ElementModel& model, const ScalarPath& scalar,
                  const ChunkFields& fields, double* f, LaneCounts& counts) {
  if (model.damping_mu > 0.0)
    forces<true>(groups, count, model, scalar, fields, f, counts);
  else
    forces<false>(groups, count, model, scalar, fields, f, counts);
}

static void energy(const ElementGroup* groups, int count, const ElementModel& model, const ScalarPath& scalar,
                   const ChunkFields& fields, double sums[8], LaneCounts& counts) {
  for_each_rotated(
      groups, count, fields, scalar, counts,
      [&](const Lanes& at, const Matrix& F, const Matrix& R, const Pack&) __attribute__((always_inline)) {
        const Matrix strain = F - R;
        const Pack trace = double_dot(R, F) - 3.0;
        const Pack density = model.mu * double_dot(strain, strain) + (0.5 * model.lambda) * trace * trace;
        *reinterpret_cast<PackInMemory*>(sums + at.first) += at.volume() * density;
      });
}

static void power(const ElementGroup* groups, int count, const ElementModel& model, const ChunkFields& fields,
                  double sums[8]) {
  for (int g = 0; g < count; ++g) {
    fetch_ahead(groups, g);
    for (int part = 0; part < 8; part += kWidth) {
      const Lanes at{groups[g], part, g};
      const Gradients G = gradients(at);
      const Symmetric rate = symmetric_product(gradient_of(at, G, fields.x), gradient_of(at, G, fields.v));
      *reinterpret_cast<PackInMemory*>(sums + part) +=
          at.volume() * double_dot(full(rate), full(damping_stress(rate, model)));
    }
  }
}

// The coupling matrix C of corotated.h.  A = tr(B) I - B is inverted by its cofactors where det A >
// kSmallestSum (tr A / 2)^2, as there.

/// @return lanes where C, times one [Pa], is right
PALPATE_INLINE Mask find_coupling(const ElementModel& model, const Matrix& F, const Matrix& R, Symmetric& C) {
  constexpr double kSmallestSum = 1e-4;  // corotated.h
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
  if (model.projected) {  // mu A - c I positive definite (Sylvester): the bound mu does not act
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
    if (scalar.coupling(model, one_F, one_R, one_C)) ++counts.clamped;
    put_lane(one_C, l, *C);
    ++counts.by_scalar;
  }
}

PALPATE_INLINE Symmetric coupling(const ElementModel& model, const Matrix& F, const Matrix& R,
                                  const ScalarPath& scalar, LaneCounts& counts) {
  if (model.warped) {
    const Pack zero{}, mu = zero + model.mu;
    return {mu, mu, mu, zero, zero, zero};
  }
  Symmetric C;
  const Mask right = find_coupling(model, F, R, C);
  if (any(~right)) [[unlikely]] {
    Matrix copy_F = F, copy_R = R, copy_C = full(C);
    Mask copy_right = right;
    couple_by_scalar(model, &copy_F, &copy_R, &copy_C, &copy_right, scalar, counts);
    C = {copy_C.row[0].x, copy_C.row[1].y, copy_C.row[2].z,
         copy_C.row[1].z, copy_C.row[0].z, copy_C.row[0].y};
  }
  return C;
}

/// dP of the elastic stress for dF, row by row: 2 mu dF + lambda tr(M) R - [turn]x R with M = dF R^T, turn =
/// C axial(M).
PALPATE_INLINE Matrix elastic_change(const ElementModel& model, const Matrix& R, const Symmetric& C,
                                     const Matrix& dF) {
  const Matrix M = times_transposed(dF, R);
  const Vector turn =
      apply(full(C), {M.row[2].y - M.row[1].z, M.row[0].z - M.row[2].x, M.row[1].x - M.row[0].y});
  const Pack stretch = model.lambda * (M.row[0].x + M.row[1].y + M.row[2].z), mu2 = Pack{} + 2.0 * model.mu;
  return {{mu2 * dF.row[0] + (stretch * R.row[0] + turn.z * R.row[1] - turn.y * R.row[2]),
           mu2 * dF.row[1] + (stretch * R.row[1] - turn.z * R.row[0] + turn.x * R.row[2]),
           mu2 * dF.row[2] + (stretch * R.row[2] + turn.y * R.row[0] - turn.x * R.row[1])}};
}

/// The stress of a linearly implicit step: that of the state and its elastic change by w, and, of what is
/// damped, that of the rate v.
template <bool kDamped>
PALPATE_INLINE Matrix step_stress(const Lanes& at, const Gradients& G, const Matrix& F, const Matrix& R,
                                  const Symmetric& C, const ElementModel& model, const ChunkFields& fields) {
  Matrix P = elastic_stress(model, F, R) + elastic_change(model, R, C, gradient_of(at, G, fields.w));
  if constexpr (kDamped)
    P = P + F * full(damping_stress(symmetric_product(F, gradient_of(at, G, fields.v)), model));
  return P;
}

template <bool kDamped>
static void step_forces(const ElementGroup* groups, int count, const ElementModel& model,
                        const ScalarPath& scalar, const ChunkFields& fields, double* f, LaneCounts& counts) {
  for_each_rotated(
      groups, count, fields, scalar, counts,
      [&](const Lanes& at, const Matrix& F, const Matrix& R, const Pack& det) __attribute__((always_inline)) {
        const Gradients G = gradients(at);
        count_inverted(det, counts);
        add_forces(at, G,
                   step_stress<kDamped>(at, G, F, R, coupling(model, F, R, scalar, counts), model, fields),
                   -at.volume(), f);
      });
}

static void step_force(const ElementGroup* groups, int count, const ElementModel& model,
                       const ScalarPath& scalar, const ChunkFields& fields, double* f, LaneCounts& counts) {
  if (model.damping_mu > 0.0)
    step_forces<true>(groups, count, model, scalar, fields, f, counts);
  else
    step_forces<false>(groups, count, model, scalar, fields, f, counts);
}

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
  for_each_rotated(
      groups, count, fields, scalar, counts,
      [&](const Lanes& at, const Matrix& F, const Matrix& R, const Pack&) __attribute__((always_inline)) {
        const Gradients G = gradients(at);
        const Matrix dF = gradient_of(at, G, fields.w);
        Matrix dP = elastic_change(model, R, coupling(model, F, R, scalar, counts), dF);
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
