#pragma once
// Parts common to all element kernels in SIMD lanes: prefetching, gradients, forces, damping. The damping
// formulas are those of objective_damping.h.

/// Vectors of elements that are computed together, so that one can proceed while the other waits for
/// divisions.
constexpr int kTogether = 2;

/// Prefetch distance in groups, into the second-level cache: the work on one group takes about 120 ns, as
/// long as a cache line from memory.
constexpr int kGroupsAhead = 16;
/// Prefetches share number `share` of the cache lines of the record kGroupsAhead later. A core can have about
/// sixteen outstanding lines; requesting all at once would delay the kernel's loads from the second-level
/// cache, so a record of many lines is prefetched in several places.
template <class Record>
PALPATE_INLINE void fetch_ahead(const Record* records, int g, int share = 0, int shares = 1) {
  constexpr int kLines = (sizeof(Record) + 63) / 64;
  // reading past the last record is harmless: the next run's records follow, and prefetches do not fault
  const char* first = reinterpret_cast<const char*>(records + g + kGroupsAhead);
  for (int line = share * kLines / shares; line < (share + 1) * kLines / shares; ++line)
    __builtin_prefetch(first + 64 * line, 0, 2);
}

PALPATE_INLINE void fetch_nodes(NodePrefetch& next) {
  const int end = next.count - next.done < next.batch ? next.count : next.done + next.batch;
  for (int k = next.done; k < end; ++k)
    for (int f = 0; f < next.field_count; ++f)
      fetch<2>(next.fields[f] + 3 * static_cast<std::int64_t>(next.nodes[k]), 24);
  next.done = end;
}

/// Prefetches a few lines of the rows that the chunk will write, once per edge of a group, so that most of
/// the rows are in flight while there is arithmetic to do.
PALPATE_INLINE void fetch_rows(RowPrefetch& rows) {
  constexpr int kLines = 5;
  if (rows.next >= rows.end) {
    if (rows.done == rows.count) return;
    const int node = rows.nodes[rows.done++];
    rows.next =
        reinterpret_cast<const char*>(rows.values + 9 * static_cast<std::int64_t>(rows.row_start[node]));
    rows.end =
        reinterpret_cast<const char*>(rows.values + 9 * static_cast<std::int64_t>(rows.row_start[node + 1]));
  }
  fetch<2>(rows.next, 64 * kLines);
  rows.next += 64 * kLines;
}

/// Lanes of group `number` of a run, from lane `first` on.
struct Lanes {
  const ElementGroup& group;
  int first, number;
  Pack inverse_edges(int entry) const { return load(group.inverse_edges[entry] + first); }
  Pack volume() const { return load(group.volume + first); }
  const std::uint16_t* node(int corner) const { return group.node[corner] + first; }
};

/// Rows g_1, g_2, g_3 of an upper triangular matrix.
struct Gradients {
  Pack xx, xy, xz, yy, yz, zz;
};
PALPATE_INLINE Gradients gradients(const Lanes& at) {
  return {at.inverse_edges(0), at.inverse_edges(1), at.inverse_edges(2),
          at.inverse_edges(3), at.inverse_edges(4), at.inverse_edges(5)};
}
/// Computes M g_0 to M g_3, where g_0 is minus the sum of the others.
PALPATE_INLINE void spread(const Matrix& M, const Gradients& G, Vector* v) {
  const Vector x{M.row[0].x, M.row[1].x, M.row[2].x}, y{M.row[0].y, M.row[1].y, M.row[2].y},
      z{M.row[0].z, M.row[1].z, M.row[2].z};
  v[1] = G.xx * x + G.xy * y + G.xz * z;
  v[2] = G.yy * y + G.yz * z;
  v[3] = G.zz * z;
  v[0] = -(v[1] + v[2] + v[3]);
}

/// Returns the gradient Ds T^-1 of a nodal field with respect to the rest position.
PALPATE_INLINE Matrix gradient_of(const Lanes& at, const Gradients& G, const double* field) {
  const Vector origin = gather(field, at.node(0));
  const Vector a = gather(field, at.node(1)) - origin, b = gather(field, at.node(2)) - origin,
               c = gather(field, at.node(3)) - origin;
  const Vector x = G.xx * a, y = G.xy * a + G.yy * b, z = G.xz * a + G.yz * b + G.zz * c;
  return {{{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}};
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
