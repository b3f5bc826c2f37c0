// The kernels of node_kernels.h for one instruction set: PALPATE_SET names it, PALPATE_LANES is its width in floats (4, 8, 16).
// Nothing here calls a function of a library: an inline one, compiled for this set, could be linked into code for another.

#include "integrate/linear/node_kernels.h"

namespace palpate::integrate {
namespace {
namespace PALPATE_SET {

#define PALPATE_INLINE [[gnu::always_inline]] static inline
#define PALPATE_INLINE_MEMBER [[gnu::always_inline]] inline

typedef float Four __attribute__((vector_size(16)));
typedef float FourAnywhere __attribute__((vector_size(16), aligned(4), may_alias));
typedef int FourIndex __attribute__((vector_size(16)));
typedef float Wide __attribute__((vector_size(4 * PALPATE_LANES)));
typedef float WideAnywhere __attribute__((vector_size(4 * PALPATE_LANES), aligned(4), may_alias));
typedef float WideInMemory __attribute__((vector_size(4 * PALPATE_LANES), may_alias));
typedef double FourDouble __attribute__((vector_size(32)));
typedef double EightDouble __attribute__((vector_size(64), aligned(8), may_alias));
typedef float Eight __attribute__((vector_size(32)));
typedef float EightAnywhere __attribute__((vector_size(32), aligned(4), may_alias));
typedef double FourDoubleAnywhere __attribute__((vector_size(32), aligned(8), may_alias));

PALPATE_INLINE Four load(const float* p) { return *reinterpret_cast<const FourAnywhere*>(p); }
PALPATE_INLINE void store(float* p, Four v) { *reinterpret_cast<FourAnywhere*>(p) = v; }
PALPATE_INLINE Four splat(float s) { return Four{s, s, s, s}; }
PALPATE_INLINE Four without_last(Four v) { return __builtin_shuffle(v, Four{}, FourIndex{0, 1, 2, 4}); }
PALPATE_INLINE double sum(Four v) { return (static_cast<double>(v[0]) + v[1]) + (static_cast<double>(v[2]) + v[3]); }

// A processor's own guess of what is read next ends at every page of 4 KiB: the blocks of a product are asked for so many numbers before, those of the original,
// which stand in another order, some rows before.
constexpr int kFloatsAhead = 1024, kBlocksAhead = 24;

// Four neighbouring lanes are the four numbers of a node, or one number of four nodes: the transposition between the two is made in all quarters of a vector at once.

typedef int WideIndex __attribute__((vector_size(4 * PALPATE_LANES)));
constexpr int kLanes = PALPATE_LANES, kParts = kLanesOfGroup / kLanes;

#if PALPATE_LANES == 16
#define PALPATE_IN_QUARTERS(a, b, c, d) a, b, c, d, a + 4, b + 4, c + 4, d + 4, a + 8, b + 8, c + 8, d + 8, a + 12, b + 12, c + 12, d + 12
#define PALPATE_REPEATED(a, b, c, d) a, b, c, d, a, b, c, d, a, b, c, d, a, b, c, d
#elif PALPATE_LANES == 8
#define PALPATE_IN_QUARTERS(a, b, c, d) a, b, c, d, a + 4, b + 4, c + 4, d + 4
#define PALPATE_REPEATED(a, b, c, d) a, b, c, d, a, b, c, d
#else
#define PALPATE_IN_QUARTERS(a, b, c, d) a, b, c, d
#endif
PALPATE_INLINE Wide low(const Wide& a, const Wide& b) { return __builtin_shufflevector(a, b, PALPATE_IN_QUARTERS(0, kLanes, 1, kLanes + 1)); }
PALPATE_INLINE Wide high(const Wide& a, const Wide& b) { return __builtin_shufflevector(a, b, PALPATE_IN_QUARTERS(2, kLanes + 2, 3, kLanes + 3)); }
PALPATE_INLINE Wide low_pairs(const Wide& a, const Wide& b) { return __builtin_shufflevector(a, b, PALPATE_IN_QUARTERS(0, 1, kLanes, kLanes + 1)); }
PALPATE_INLINE Wide high_pairs(const Wide& a, const Wide& b) { return __builtin_shufflevector(a, b, PALPATE_IN_QUARTERS(2, 3, kLanes + 2, kLanes + 3)); }

/// Four numbers from at[0], at[4], ... side by side.
PALPATE_INLINE Wide every_fourth(const float* field, const int* at) {
#if PALPATE_LANES == 4
  return load(field + at[0]);
#else
  const Eight front = __builtin_shufflevector(load(field + at[0]), load(field + at[4]), 0, 1, 2, 3, 4, 5, 6, 7);
#if PALPATE_LANES == 8
  return front;
#else
  const Eight back = __builtin_shufflevector(load(field + at[8]), load(field + at[12]), 0, 1, 2, 3, 4, 5, 6, 7);
  return __builtin_shufflevector(front, back, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
#endif
#endif
}

struct Lanes3 {
  Wide x, y, z;
};
/// field[at[l]], field[at[l] + 1], field[at[l] + 2] in lane l.
PALPATE_INLINE void gather(const float* field, const int* at, Lanes3& v) {
  const Wide a = every_fourth(field, at), b = every_fourth(field, at + 1), c = every_fourth(field, at + 2), d = every_fourth(field, at + 3);
  const Wide ab = low(a, b), cd = low(c, d);
  v.x = low_pairs(ab, cd);
  v.y = high_pairs(ab, cd);
  v.z = low_pairs(high(a, b), high(c, d));
}
template <int kQuarter>
PALPATE_INLINE Four quarter(const Wide& v) {
  return __builtin_shufflevector(v, v, 4 * kQuarter, 4 * kQuarter + 1, 4 * kQuarter + 2, 4 * kQuarter + 3);
}
/// The way back: put(lane, x y z 0) for each lane.
template <class Put>
PALPATE_INLINE void each_lane(const Lanes3& v, Put&& put) {
  const Wide none{}, xy = low(v.x, v.y), z = low(v.z, none), xy_high = high(v.x, v.y), z_high = high(v.z, none);
  const Wide rows[4] = {low_pairs(xy, z), high_pairs(xy, z), low_pairs(xy_high, z_high), high_pairs(xy_high, z_high)};
  for (int k = 0; k < 4; ++k) {
    put(k, quarter<0>(rows[k]));
#if PALPATE_LANES >= 8
    put(k + 4, quarter<1>(rows[k]));
#endif
#if PALPATE_LANES == 16
    put(k + 8, quarter<2>(rows[k]));
    put(k + 12, quarter<3>(rows[k]));
#endif
  }
}
PALPATE_INLINE void scatter_add(float* field, const int* at, const Lanes3& v) {
  each_lane(v, [&](int lane, const Four& three) __attribute__((always_inline)) { store(field + at[lane], load(field + at[lane]) + three); });
}
PALPATE_INLINE Lanes3 operator-(const Lanes3& a, const Lanes3& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
PALPATE_INLINE Lanes3 operator+(const Lanes3& a, const Lanes3& b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }

PALPATE_INLINE Wide number(const float* values, int k) { return *reinterpret_cast<const WideInMemory*>(values + kLanesOfGroup * k); }

/// B v and B^T v of the blocks at `values`.
PALPATE_INLINE Lanes3 times(const float* values, const Lanes3& v) {
  return {number(values, 0) * v.x + number(values, 3) * v.y + number(values, 6) * v.z, number(values, 1) * v.x + number(values, 4) * v.y + number(values, 7) * v.z,
          number(values, 2) * v.x + number(values, 5) * v.y + number(values, 8) * v.z};
}
PALPATE_INLINE Lanes3 turned_times(const float* values, const Lanes3& v) {
  return {number(values, 0) * v.x + number(values, 1) * v.y + number(values, 2) * v.z, number(values, 3) * v.x + number(values, 4) * v.y + number(values, 5) * v.z,
          number(values, 6) * v.x + number(values, 7) * v.y + number(values, 8) * v.z};
}

/// Q += A P for N vectors by one part of a group; of a balanced matrix without the mass.
template <bool kWhole, int N>
PALPATE_INLINE void add_group(const PackedRows& A, const float* const* P, float* const* Q, int group, int part) {
  const int *row = A.row + kLanesOfGroup * group + kLanes * part, single = A.single_start[group], end = A.step_start[group + 1];
  const int* column = A.column + kLanesOfGroup * static_cast<std::int64_t>(A.step_start[group]) + kLanes * part;
  const float* values = A.values + kNumbersOfStep * static_cast<std::int64_t>(A.step_start[group]) + kLanes * part;
  Lanes3 own[N], sum[N], v;
  for (int n = 0; n < N; ++n) {
    gather(P[n], row, own[n]);
    sum[n] = kWhole ? times(values, own[n]) : Lanes3{};
  }
  int s = A.step_start[group];
  const auto next = [&]() __attribute__((always_inline)) {
    ++s;
    column += kLanesOfGroup;
    values += kNumbersOfStep;
    if (part == 0)
      for (int line = 0; line < kNumbersOfStep; line += 16) __builtin_prefetch(values + kFloatsAhead + line);
  };
  for (next(); s < single; next())
    for (int n = 0; n < N; ++n) {
      gather(P[n], column, v);
      if constexpr (!kWhole) v = v - own[n];
      sum[n] = sum[n] + times(values, v);
      if constexpr (kWhole)
        scatter_add(Q[n], column, turned_times(values, own[n]));
      else
        scatter_add(Q[n], column, Lanes3{} - turned_times(values, v));
    }
  for (; s < end; next())
    for (int n = 0; n < N; ++n) {
      gather(P[n], column, v);
      if constexpr (!kWhole) v = v - own[n];
      sum[n] = sum[n] + times(values, v);
    }
  for (int n = 0; n < N; ++n) scatter_add(Q[n], row, sum[n]);
}

template <int N>
PALPATE_INLINE void set_zero(const PackedRows& A, float* const* Q) {
  for (int n = 0; n < N; ++n)
    for (int i = A.first_node; i < A.last_node; ++i) store(Q[n] + 4 * i, Four{});
}
template <int N>
PALPATE_INLINE void add_groups(const PackedRows& A, const float* const* P, float* const* Q) {
  set_zero<N>(A, Q);
  for (int g = A.first_group; g < A.last_group; ++g)
    for (int part = 0; part < kParts; ++part) {
      if (A.mass)
        add_group<false, N>(A, P, Q, g, part);
      else
        add_group<true, N>(A, P, Q, g, part);
    }
}

double product(const PackedRows& A, const float* p, float* q) {
  add_groups<1>(A, &p, &q);
  Four pq{};
  for (int i = A.first_node; i < A.last_node; ++i) {
    const Four point = load(p + 4 * i);
    Four image = load(q + 4 * i);
    if (A.mass) {
      image += load(A.mass + 4 * i) * point;
      store(q + 4 * i, image);
    }
    pq += point * image;
  }
  return sum(pq);
}

/// work(Count<n>) for n columns: their sums stay in registers.
template <int N>
struct Count {
  static constexpr int value = N;
};
template <class Work>
PALPATE_INLINE auto by_count(int count, Work&& work) {
  static_assert(kMostColumns == 5);
  switch (count) {
    case 0: return work(Count<0>{});
    case 1: return work(Count<1>{});
    case 2: return work(Count<2>{});
    case 3: return work(Count<3>{});
    case 4: return work(Count<4>{});
    default: return work(Count<5>{});
  }
}

template <int N>
PALPATE_INLINE void add_mass(const PackedRows& A, const float* const* V, float* const* AV) {
  for (int i = A.first_node; i < A.last_node; ++i)
    for (int n = 0; n < N; ++n) store(AV[n] + 4 * i, load(AV[n] + 4 * i) + load(A.mass + 4 * i) * load(V[n] + 4 * i));
}
template <int N>
PALPATE_INLINE void multiply_columns(const PackedRows& A, const float* const* V, float* const* AV) {
  if constexpr (N > 0) {
    add_groups<N>(A, V, AV);
    if (A.mass) add_mass<N>(A, V, AV);
  }
}
void multiply(const PackedRows& A, int count, const float* const* V, float* const* AV) {
  by_count(count, [&](auto n) __attribute__((always_inline)) { multiply_columns<decltype(n)::value>(A, V, AV); });
}

/// Asks for the blocks of a later step.
PALPATE_INLINE void fetch_blocks(const BlockSource& from, std::int64_t step) {
  const int* later = from.offset + kLanesOfGroup * (step + kStepsAhead);
  for (int l = 0; l < kLanesOfGroup; ++l) __builtin_prefetch(from.values + later[l]);
}
/// The blocks of one part of a step, entry (r, c) at [3 c + r].
PALPATE_INLINE void take_blocks(const BlockSource& from, std::int64_t step, int part, Wide* block) {
  const int* offset = from.offset + kLanesOfGroup * step + kLanes * part;
  for (int c = 0; c < 3; ++c) {
    Lanes3 column;
    gather(from.values + 3 * c, offset, column);
    block[3 * c] = column.x;
    block[3 * c + 1] = column.y;
    block[3 * c + 2] = column.z;
  }
  if (!from.turned) return;
  WideIndex turned;
  for (int l = 0; l < kLanes; ++l) turned[l] = 1 << l;
  turned = (turned & (from.turned[step] >> (kLanes * part))) != 0;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < c; ++r) {
      const Wide above = block[3 * c + r], below = block[3 * r + c];
      block[3 * c + r] = turned ? below : above;
      block[3 * r + c] = turned ? above : below;
    }
}
PALPATE_INLINE void put_blocks(const PackedRows& A, std::int64_t step, int part, const Wide* block) {
  for (int k = 0; k < 9; ++k) *reinterpret_cast<WideInMemory*>(A.values + kNumbersOfStep * step + kLanes * part + kLanesOfGroup * k) = block[k];
}

void pack(const PackedRows& A, const BlockSource& from) {
  for (std::int64_t s = A.step_start[A.first_group]; s < A.step_start[A.last_group]; ++s)
    for (int part = 0; part < kParts; ++part) {
      Wide block[9];
      if (part == 0) fetch_blocks(from, s);
      take_blocks(from, s, part, block);
      put_blocks(A, s, part, block);
    }
}

/// xx, yy, zz and yz, xz, xy of symmetric blocks.
struct Symmetric {
  Lanes3 diagonal, off;
};
PALPATE_INLINE Symmetric symmetric_part(const Wide* block) {
  return {{block[0], block[4], block[8]}, {0.5f * (block[7] + block[5]), 0.5f * (block[6] + block[2]), 0.5f * (block[3] + block[1])}};
}

/// By cofactors of the block over its trace.  Positive definite exactly when the leading minors are (Sylvester).
PALPATE_INLINE WideIndex invert_own(const Symmetric& own, float* inverse, const int* row) {
  const Wide trace = own.diagonal.x + own.diagonal.y + own.diagonal.z, by = 1.0f / trace;
  const Wide xx = by * own.diagonal.x, yy = by * own.diagonal.y, zz = by * own.diagonal.z, yz = by * own.off.x, xz = by * own.off.y, xy = by * own.off.z;
  const Wide a = yy * zz - yz * yz, b = xz * yz - xy * zz, c = xy * yz - xz * yy;
  const Wide minor = xx * yy - xy * xy, det = xx * a + xy * b + xz * c, scale = by / det;
  const Wide d = (xx * zz - xz * xz) * scale, e = (xy * xz - xx * yz) * scale;
  const auto put = [&](int to, const Lanes3& three) __attribute__((always_inline)) {
    each_lane(three, [&](int lane, const Four& numbers) __attribute__((always_inline)) { store(inverse + inverse_place(row[lane] / 4) + to, numbers); });
  };
  put(0, {a * scale, d, minor * scale});
  put(kToOffDiagonal, {e, c * scale, b * scale});
  return (trace > 0.0f) & (xx > 0.0f) & (minor > 0.0f) & (det > 0.0f);
}

template <int N>
PALPATE_INLINE Balanced balance_columns(const PackedRows& A, const BlockSource& from, float* sums, float* inverse, double* trace, const float* const* V, float* const* AV) {
  set_zero<N>(A, AV);
  float* off = sums + 4;  // eight numbers a node
  for (int i = A.first_node; i < A.last_node; ++i) {
    store(sums + 8 * i, Four{});
    store(off + 8 * i, Four{});
  }
  const auto add = [&](const int* at, const Symmetric& part) __attribute__((always_inline)) {
    each_lane(part.diagonal, [&](int lane, const Four& three) __attribute__((always_inline)) { store(sums + 2 * at[lane], load(sums + 2 * at[lane]) + three); });
    each_lane(part.off, [&](int lane, const Four& three) __attribute__((always_inline)) { store(off + 2 * at[lane], load(off + 2 * at[lane]) + three); });
  };
  for (int g = A.first_group; g < A.last_group; ++g)
    for (int part = 0; part < kParts; ++part) {
      Symmetric row{};
      for (std::int64_t s = A.step_start[g] + 1; s < A.step_start[g + 1]; ++s) {
        Wide block[9];
        if (part == 0) fetch_blocks(from, s);
        take_blocks(from, s, part, block);
        put_blocks(A, s, part, block);
        const Symmetric middle = symmetric_part(block);
        row = {row.diagonal + middle.diagonal, row.off + middle.off};
        if (s < A.single_start[g]) add(A.column + kLanesOfGroup * s + kLanes * part, middle);
      }
      add(A.row + kLanesOfGroup * g + kLanes * part, row);
      if constexpr (N > 0) add_group<false, N>(A, V, AV, g, part);  // while the blocks are at hand
    }
  add_mass<N>(A, V, AV);
  WideIndex definite = WideIndex{} == 0;
  Wide probe{};  // 0 x is no number where x is infinite or none
  for (int g = A.first_group; g < A.last_group; ++g)
    for (int part = 0; part < kParts; ++part) {
      const int* row = A.row + kLanesOfGroup * g + kLanes * part;
      int twice[kLanes];
      for (int l = 0; l < kLanes; ++l) twice[l] = 2 * row[l];
      Lanes3 m;
      Symmetric own;
      gather(A.mass, row, m);
      gather(sums, twice, own.diagonal);
      gather(off, twice, own.off);
      probe += (own.diagonal.x + own.diagonal.y + own.diagonal.z + own.off.x + own.off.y + own.off.z) * 0.0f;
      own = {m - own.diagonal, Lanes3{} - own.off};
      const Wide block[9] = {own.diagonal.x, own.off.z, own.off.y, own.off.z, own.diagonal.y, own.off.x, own.off.y, own.off.x, own.diagonal.z};
      put_blocks(A, A.step_start[g], part, block);
      definite &= invert_own(own, inverse, row);
    }
  double traces = 0.0;
  for (int i = A.first_node; i < A.last_node; ++i)
    for (int axis = 0; axis < 3; ++axis) traces += A.mass[4 * i + axis] - sums[8 * i + axis];
  *trace = traces;
  for (int l = 0; l < kLanes; ++l)
    if (!(probe[l] == 0.0f)) return Balanced::kNotFinite;
  for (int l = 0; l < kLanes; ++l)
    if (!definite[l]) return Balanced::kNotDefinite;
  return Balanced::kOk;
}
Balanced balance(const PackedRows& A, const BlockSource& from, float* sums, float* inverse, double* trace, int count, const float* const* V, float* const* AV) {
  return by_count(count, [&](auto n) __attribute__((always_inline)) { return balance_columns<decltype(n)::value>(A, from, sums, inverse, trace, V, AV); });
}

// Vectors over the nodes, as many nodes as fit a vector at a time; those before and behind, one at a time.

template <int kWidth>
struct NodesAtATime;
template <>
struct NodesAtATime<4> {
  using Numbers = Four;
  static constexpr int kNodes = 1;
  PALPATE_INLINE_MEMBER static Four take(const float* p) { return load(p); }
  PALPATE_INLINE_MEMBER static void put(float* p, const Four& v) { store(p, v); }
  PALPATE_INLINE_MEMBER static Four spread(const Four& v) { return v; }
  PALPATE_INLINE_MEMBER static Four yzx(const Four& v) { return __builtin_shufflevector(v, v, 1, 2, 0, 3); }
  PALPATE_INLINE_MEMBER static Four zxy(const Four& v) { return __builtin_shufflevector(v, v, 2, 0, 1, 3); }
  PALPATE_INLINE_MEMBER static Four fourth(const Four& v) { return __builtin_shufflevector(v, v, 3, 3, 3, 3); }
};
#if PALPATE_LANES > 4
template <>
struct NodesAtATime<PALPATE_LANES> {
  using Numbers = Wide;
  static constexpr int kNodes = PALPATE_LANES / 4;
  PALPATE_INLINE_MEMBER static Wide take(const float* p) { return *reinterpret_cast<const WideAnywhere*>(p); }
  PALPATE_INLINE_MEMBER static void put(float* p, const Wide& v) { *reinterpret_cast<WideAnywhere*>(p) = v; }
  PALPATE_INLINE_MEMBER static Wide spread(const Four& v) { return __builtin_shufflevector(v, v, PALPATE_REPEATED(0, 1, 2, 3)); }
  PALPATE_INLINE_MEMBER static Wide yzx(const Wide& v) { return __builtin_shufflevector(v, v, PALPATE_IN_QUARTERS(1, 2, 0, 3)); }
  PALPATE_INLINE_MEMBER static Wide zxy(const Wide& v) { return __builtin_shufflevector(v, v, PALPATE_IN_QUARTERS(2, 0, 1, 3)); }
  PALPATE_INLINE_MEMBER static Wide fourth(const Wide& v) { return __builtin_shufflevector(v, v, PALPATE_IN_QUARTERS(3, 3, 3, 3)); }
};
#endif
/// work(NodesAtATime, first of these nodes); several begin at a multiple of their number.
template <class Work>
PALPATE_INLINE void over_nodes(int first, int last, Work&& work) {
  using One = NodesAtATime<4>;
  using Several = NodesAtATime<PALPATE_LANES>;
  int i = first;
  for (; i < last && i % Several::kNodes != 0; ++i) work(One{}, i);
  for (; i + Several::kNodes <= last; i += Several::kNodes) work(Several{}, i);
  for (; i < last; ++i) work(One{}, i);
}
/// A sum over nodes: four numbers, of one node or of several at a time.
struct SumOverNodes {
  Four one{};
  Wide several{};
  PALPATE_INLINE_MEMBER void add(NodesAtATime<4>, const Four& v) { one += v; }
#if PALPATE_LANES > 4
  PALPATE_INLINE_MEMBER void add(NodesAtATime<PALPATE_LANES>, const Wide& v) { several += v; }
#endif
  PALPATE_INLINE_MEMBER Four four() const {
    Four total = one;
    for (int l = 0; l < kLanes; l += 4) total += Four{several[l], several[l + 1], several[l + 2], several[l + 3]};
    return total;
  }
  PALPATE_INLINE_MEMBER double all() const {
    double total = sum(one);
    for (int l = 0; l < kLanes; l += 4) total += sum(Four{several[l], several[l + 1], several[l + 2], several[l + 3]});
    return total;
  }
};

template <class N>
PALPATE_INLINE typename N::Numbers cross(N, const typename N::Numbers& a, const typename N::Numbers& b) {
  return N::yzx(a * N::yzx(b) - N::yzx(a) * b);
}
/// Row by row: xx x + xy y + xz z is of D r, then of (xy yz xz) (y z x), then of (xz xy yz) (z x y).
template <class N>
PALPATE_INLINE typename N::Numbers times_inverse(N, const float* inverse, int i, const typename N::Numbers& r) {
  const float* J = inverse + inverse_place(i);
  const auto off = N::take(J + kToOffDiagonal);
  return N::take(J) * r + N::zxy(off) * N::yzx(r) + N::yzx(off) * N::zxy(r);
}

double update(float a, const float* q, const float* inverse, float* r, float* z, int first, int last) {
  SumOverNodes rz;
  over_nodes(first, last, [&](auto n, int i) __attribute__((always_inline)) {
    using N = decltype(n);
    const auto residual = N::take(r + 4 * i) - a * N::take(q + 4 * i), image = times_inverse(n, inverse, i, residual);
    N::put(r + 4 * i, residual);
    N::put(z + 4 * i, image);
    rz.add(n, residual * image);
  });
  return rz.all();
}

double jacobi(const float* inverse, const float* r, float* z, int first, int last) {
  SumOverNodes rz;
  over_nodes(first, last, [&](auto n, int i) __attribute__((always_inline)) {
    using N = decltype(n);
    const auto residual = N::take(r + 4 * i), image = times_inverse(n, inverse, i, residual);
    N::put(z + 4 * i, image);
    rz.add(n, residual * image);
  });
  return rz.all();
}

void gather_rigid(const float* r, const float* arm, float* y, int first, int last) {
  SumOverNodes force, moment;
  over_nodes(first, last, [&](auto n, int i) __attribute__((always_inline)) {
    using N = decltype(n);
    const auto at = N::take(arm + 4 * i), residual = N::fourth(at) * N::take(r + 4 * i);
    force.add(n, residual);
    moment.add(n, cross(n, at, residual));
  });
  const Four f = force.four(), m = moment.four();
  for (int axis = 0; axis < 3; ++axis) {
    y[axis] = f[axis];
    y[3 + axis] = m[axis];
  }
}

void direction(float a, float b, const float* z, const float* arm, const float* motion, float* d, float* p, int first, int last) {
  if (!motion) {
    over_nodes(first, last, [&](auto n, int i) __attribute__((always_inline)) {
      using N = decltype(n);
      const auto before = N::take(p + 4 * i);
      N::put(d + 4 * i, N::take(d + 4 * i) + a * before);
      N::put(p + 4 * i, N::take(z + 4 * i) + b * before);
    });
    return;
  }
  const Four shift{motion[0], motion[1], motion[2], 0.0f}, turn{motion[3], motion[4], motion[5], 0.0f};
  over_nodes(first, last, [&](auto n, int i) __attribute__((always_inline)) {
    using N = decltype(n);
    const auto before = N::take(p + 4 * i), at = N::take(arm + 4 * i);
    N::put(d + 4 * i, N::take(d + 4 * i) + a * before);
    N::put(p + 4 * i, N::take(z + 4 * i) + N::fourth(at) * N::spread(shift) + cross(n, N::spread(turn), at) + b * before);
  });
}

void dense(const float* E, int stride, const float* y, float* w, int first, int last) {
  for (int i = first; i < last; ++i) {
    const float* row = E + static_cast<std::int64_t>(i) * stride;
    Wide even{}, odd{};
    int j = 0;
    for (; j + 2 * PALPATE_LANES <= stride; j += 2 * PALPATE_LANES) {
      even += *reinterpret_cast<const WideAnywhere*>(row + j) * *reinterpret_cast<const WideAnywhere*>(y + j);
      odd += *reinterpret_cast<const WideAnywhere*>(row + j + PALPATE_LANES) * *reinterpret_cast<const WideAnywhere*>(y + j + PALPATE_LANES);
    }
    for (; j < stride; j += PALPATE_LANES) even += *reinterpret_cast<const WideAnywhere*>(row + j) * *reinterpret_cast<const WideAnywhere*>(y + j);
    even += odd;
    float total = 0.0f;
    for (int l = 0; l < PALPATE_LANES; ++l) total += even[l];
    w[i] = total;
  }
}

// Gauss and Jordan without a choice of pivots, which a positive definite matrix does not need: sweep k replaces row and column k's unknown.
bool invert(float* E, int size, int stride) {
  for (int k = 0; k < size; ++k) {
    float* pivot_row = E + static_cast<std::int64_t>(k) * stride;
    const float pivot = pivot_row[k];
    if (!(pivot > 0.0f)) return false;
    const float inverse = 1.0f / pivot;
    pivot_row[k] = 1.0f;
    for (int j = 0; j < stride; j += PALPATE_LANES) *reinterpret_cast<WideAnywhere*>(pivot_row + j) *= inverse;
    for (int i = 0; i < size; ++i) {
      if (i == k) continue;
      float* row = E + static_cast<std::int64_t>(i) * stride;
      const float factor = row[k];
      if (factor == 0.0f) continue;
      row[k] = 0.0f;
      for (int j = 0; j < stride; j += PALPATE_LANES) *reinterpret_cast<WideAnywhere*>(row + j) -= factor * *reinterpret_cast<const WideAnywhere*>(pivot_row + j);
    }
  }
  for (int i = 0; i < size; ++i)  // symmetric but for rounding: make it so
    for (int j = 0; j < i; ++j) {
      float &low = E[static_cast<std::int64_t>(i) * stride + j], &high = E[static_cast<std::int64_t>(j) * stride + i];
      low = high = 0.5f * (low + high);
    }
  return true;
}

PALPATE_INLINE double sum3(const FourDouble& v) { return (v[0] + v[1]) + v[2]; }

bool convert(const DoubleBlocks& A, double scale, float* out, int first, int last) {
  Eight probe{};  // 0 x is no number where x is infinite or none
  float probe_last = 0.0f;
  const int end_of_all = A.row_start[last];
  for (int s = A.row_start[first]; s < end_of_all; ++s) {
    const double* block = A.values + 9 * static_cast<std::int64_t>(A.source[s]);
    if (s + kBlocksAhead < end_of_all) {
      const double* later = A.values + 9 * static_cast<std::int64_t>(A.source[s + kBlocksAhead]);
      __builtin_prefetch(later);
      __builtin_prefetch(later + 8);
    }
    float* to = out + 9 * static_cast<std::int64_t>(s);
    const Eight rows = __builtin_convertvector(*reinterpret_cast<const EightDouble*>(block) * scale, Eight);
    *reinterpret_cast<EightAnywhere*>(to) = __builtin_shufflevector(rows, rows, 0, 3, 6, 1, 4, 7, 2, 5);
    to[8] = static_cast<float>(scale * block[8]);
    probe += rows * 0.0f;
    probe_last += to[8] * 0.0f;
  }
  for (int l = 0; l < 8; ++l) probe_last += probe[l];
  return probe_last == 0.0f;
}

void multiply_double(const DoubleBlocks& A, const double* v, double* Av, int first, int last) {
  const int end_of_all = A.row_start[last];
  for (int i = first; i < last; ++i) {
    FourDouble total[3] = {};
    for (int s = A.row_start[i]; s < A.row_start[i + 1]; ++s) {
      const double* block = A.values + 9 * static_cast<std::int64_t>(A.source[s]);
      if (s + kBlocksAhead < end_of_all) {
        const double* later = A.values + 9 * static_cast<std::int64_t>(A.source[s + kBlocksAhead]);
        __builtin_prefetch(later);
        __builtin_prefetch(later + 8);
      }
      double copy[10];
      if (A.source[s] == A.last_slot) {  // the last row of a block is read with the number behind it
        for (int k = 0; k < 9; ++k) copy[k] = block[k];
        copy[9] = 0.0;
        block = copy;
      }
      const FourDouble x = *reinterpret_cast<const FourDoubleAnywhere*>(v + 4 * static_cast<std::int64_t>(A.column[s]));
      for (int r = 0; r < 3; ++r) total[r] += *reinterpret_cast<const FourDoubleAnywhere*>(block + 3 * r) * x;
    }
    double* y = Av + 4 * static_cast<std::int64_t>(i);
    for (int r = 0; r < 3; ++r) y[r] = sum3(total[r]);
    y[3] = 0.0;
  }
}

// Products of a balanced matrix in double, half as many rows at a time.

constexpr int kHalf = PALPATE_LANES / 2;
typedef double Half __attribute__((vector_size(8 * kHalf)));
typedef float HalfSingle __attribute__((vector_size(4 * kHalf), may_alias));

struct Half3 {
  Half x, y, z;
};
#if PALPATE_LANES == 16
PALPATE_INLINE Half beside(const double* front, const double* back) {
  return __builtin_shufflevector(FourDouble(*reinterpret_cast<const FourDoubleAnywhere*>(front)), FourDouble(*reinterpret_cast<const FourDoubleAnywhere*>(back)), 0, 1, 2, 3, 4, 5, 6, 7);
}
PALPATE_INLINE void gather(const double* field, const int* at, Half3& v) {
  const Half a = beside(field + at[0], field + at[4]), b = beside(field + at[1], field + at[5]), c = beside(field + at[2], field + at[6]), d = beside(field + at[3], field + at[7]);
  const Half ab = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14), cd = __builtin_shufflevector(c, d, 0, 8, 2, 10, 4, 12, 6, 14);
  const Half ab_y = __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15), cd_y = __builtin_shufflevector(c, d, 1, 9, 3, 11, 5, 13, 7, 15);
  v.x = __builtin_shufflevector(ab, cd, 0, 1, 8, 9, 4, 5, 12, 13);
  v.y = __builtin_shufflevector(ab_y, cd_y, 0, 1, 8, 9, 4, 5, 12, 13);
  v.z = __builtin_shufflevector(ab, cd, 2, 3, 10, 11, 6, 7, 14, 15);
}
#elif PALPATE_LANES == 8
PALPATE_INLINE void gather(const double* field, const int* at, Half3& v) {
  Half n[4];
  for (int l = 0; l < 4; ++l) n[l] = *reinterpret_cast<const FourDoubleAnywhere*>(field + at[l]);
  const Half ab = __builtin_shufflevector(n[0], n[1], 0, 4, 2, 6), cd = __builtin_shufflevector(n[2], n[3], 0, 4, 2, 6);
  const Half ab_y = __builtin_shufflevector(n[0], n[1], 1, 5, 3, 7), cd_y = __builtin_shufflevector(n[2], n[3], 1, 5, 3, 7);
  v.x = __builtin_shufflevector(ab, cd, 0, 1, 4, 5);
  v.y = __builtin_shufflevector(ab_y, cd_y, 0, 1, 4, 5);
  v.z = __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
}
#else
PALPATE_INLINE void gather(const double* field, const int* at, Half3& v) {
  const double *p = field + at[0], *q = field + at[1];
  v.x = Half{p[0], q[0]};
  v.y = Half{p[1], q[1]};
  v.z = Half{p[2], q[2]};
}
#endif

PALPATE_INLINE void subtract_four(double* p, const FourDouble& v) { *reinterpret_cast<FourDoubleAnywhere*>(p) = *reinterpret_cast<const FourDoubleAnywhere*>(p) - v; }
#if PALPATE_LANES == 16
PALPATE_INLINE void scatter_subtract(double* field, const int* at, const Half3& v) {
  const Half none{};
  const Half xy = __builtin_shufflevector(v.x, v.y, 0, 8, 2, 10, 4, 12, 6, 14), z = __builtin_shufflevector(v.z, none, 0, 8, 2, 10, 4, 12, 6, 14);
  const Half xy_odd = __builtin_shufflevector(v.x, v.y, 1, 9, 3, 11, 5, 13, 7, 15), z_odd = __builtin_shufflevector(v.z, none, 1, 9, 3, 11, 5, 13, 7, 15);
  const Half rows[4] = {__builtin_shufflevector(xy, z, 0, 1, 8, 9, 4, 5, 12, 13), __builtin_shufflevector(xy_odd, z_odd, 0, 1, 8, 9, 4, 5, 12, 13),
                        __builtin_shufflevector(xy, z, 2, 3, 10, 11, 6, 7, 14, 15), __builtin_shufflevector(xy_odd, z_odd, 2, 3, 10, 11, 6, 7, 14, 15)};
  for (int l = 0; l < 4; ++l) {
    subtract_four(field + at[l], __builtin_shufflevector(rows[l], rows[l], 0, 1, 2, 3));
    subtract_four(field + at[l + 4], __builtin_shufflevector(rows[l], rows[l], 4, 5, 6, 7));
  }
}
#elif PALPATE_LANES == 8
PALPATE_INLINE void scatter_subtract(double* field, const int* at, const Half3& v) {
  const Half none{};
  const Half xy = __builtin_shufflevector(v.x, v.y, 0, 4, 2, 6), z = __builtin_shufflevector(v.z, none, 0, 4, 2, 6);
  const Half xy_odd = __builtin_shufflevector(v.x, v.y, 1, 5, 3, 7), z_odd = __builtin_shufflevector(v.z, none, 1, 5, 3, 7);
  subtract_four(field + at[0], __builtin_shufflevector(xy, z, 0, 1, 4, 5));
  subtract_four(field + at[1], __builtin_shufflevector(xy_odd, z_odd, 0, 1, 4, 5));
  subtract_four(field + at[2], __builtin_shufflevector(xy, z, 2, 3, 6, 7));
  subtract_four(field + at[3], __builtin_shufflevector(xy_odd, z_odd, 2, 3, 6, 7));
}
#else
PALPATE_INLINE void scatter_subtract(double* field, const int* at, const Half3& v) {
  for (int l = 0; l < kHalf; ++l) {
    double* to = field + at[l];
    to[0] -= v.x[l];
    to[1] -= v.y[l];
    to[2] -= v.z[l];
  }
}
#endif

void multiply_balanced(const PackedRows& A, const double* mass, double unit, const double* v, double* Av) {
  const std::int64_t begin = 4 * static_cast<std::int64_t>(A.first_node), end = 4 * static_cast<std::int64_t>(A.last_node);
  for (std::int64_t k = begin; k < end; ++k) Av[k] = 0.0;
  for (int g = A.first_group; g < A.last_group; ++g)
    for (int part = 0; part < 2 * kParts; ++part) {
      const int* row = A.row + kLanesOfGroup * g + kHalf * part;
      Half3 own, sum{}, other;
      gather(v, row, own);
      for (std::int64_t s = A.step_start[g] + 1; s < A.step_start[g + 1]; ++s) {
        const float* values = A.values + kNumbersOfStep * s + kHalf * part;
        const int* column = A.column + kLanesOfGroup * s + kHalf * part;
        if (part == 0)
          for (int line = 0; line < kNumbersOfStep; line += 16) __builtin_prefetch(values + kFloatsAhead + line);
        Half block[9];
        for (int k = 0; k < 9; ++k) block[k] = __builtin_convertvector(*reinterpret_cast<const HalfSingle*>(values + kLanesOfGroup * k), Half);
        gather(v, column, other);
        const Half x = other.x - own.x, y = other.y - own.y, z = other.z - own.z;
        sum = {sum.x - block[0] * x - block[3] * y - block[6] * z, sum.y - block[1] * x - block[4] * y - block[7] * z, sum.z - block[2] * x - block[5] * y - block[8] * z};
        if (s < A.single_start[g])
          scatter_subtract(Av, column, {block[0] * x + block[1] * y + block[2] * z, block[3] * x + block[4] * y + block[5] * z, block[6] * x + block[7] * y + block[8] * z});
      }
      scatter_subtract(Av, row, sum);
    }
  for (std::int64_t k = begin; k < end; ++k) Av[k] = unit * (Av[k] + mass[k] * v[k]);
}

PALPATE_INLINE void take(const float* p, FourDouble& out) { out = __builtin_convertvector(load(p), FourDouble); }
PALPATE_INLINE void take(const double* p, FourDouble& out) { out = *reinterpret_cast<const FourDoubleAnywhere*>(p); }
PALPATE_INLINE void put(double* p, const FourDouble& v) { *reinterpret_cast<FourDoubleAnywhere*>(p) = v; }

template <int N>
[[gnu::always_inline]] static inline void gram_of(const float* const* V, const float* const* AV, const double* b, int first, int last, double* out) {
  FourDouble sum[kMostSums] = {};
  for (std::int64_t k = 4 * static_cast<std::int64_t>(first); k < 4 * static_cast<std::int64_t>(last); k += 4) {
    FourDouble v[N + 1], Av[N + 1], right;
    for (int n = 0; n < N; ++n) {
      take(V[n] + k, v[n]);
      take(AV[n] + k, Av[n]);
    }
    take(b + k, right);
    int at = 0;
    for (int j = 0; j < N; ++j)
      for (int i = 0; i <= j; ++i) sum[at++] += v[j] * Av[i];
    for (int j = 0; j < N; ++j) sum[at++] += v[j] * right;
  }
  for (int at = 0; at < N * (N + 1) / 2 + N; ++at) out[at] = sum3(sum[at]);
}
void gram(int count, const float* const* V, const float* const* AV, const double* b, int first, int last, double* out) {
  by_count(count, [&](auto n) __attribute__((always_inline)) { gram_of<decltype(n)::value>(V, AV, b, first, last, out); });
}

template <int N>
[[gnu::always_inline]] static inline double combine_of(const double* y, double scale, const float* const* V, const float* const* AV, const double* b, double* x,
                                                       double* Ax, int first, int last) {
  FourDouble square{};
  for (std::int64_t k = 4 * static_cast<std::int64_t>(first); k < 4 * static_cast<std::int64_t>(last); k += 4) {
    FourDouble point{}, image{}, right, v;
    for (int n = 0; n < N; ++n) {
      take(V[n] + k, v);
      point += y[n] * v;
      take(AV[n] + k, v);
      image += y[n] * v;
    }
    put(x + k, scale * point);
    put(Ax + k, image);
    take(b + k, right);
    right -= image;
    square += right * right;
  }
  return sum3(square);
}
double combine(int count, const double* y, double scale, const float* const* V, const float* const* AV, const double* b, double* x, double* Ax, int first, int last) {
  return by_count(count, [&](auto n) __attribute__((always_inline)) { return combine_of<decltype(n)::value>(y, scale, V, AV, b, x, Ax, first, last); });
}

template <int N>
[[gnu::always_inline]] static inline void difference_of(double by, double change, const double* x, float* const* V, int first, int last) {
  for (std::int64_t k = 4 * static_cast<std::int64_t>(first); k < 4 * static_cast<std::int64_t>(last); k += 4) {
    FourDouble value, old;
    take(x + k, value);
    value *= by;
    for (int n = 0; n < N; ++n) {
      take(V[n] + k, old);
      store(V[n] + k, __builtin_convertvector(value, Four));
      value -= change * old;
    }
  }
}
void difference(int count, double by, double change, const double* x, float* const* V, int first, int last) {
  by_count(count, [&](auto n) __attribute__((always_inline)) { difference_of<decltype(n)::value>(by, change, x, V, first, last); });
}

void residual(double by, const double* b, const double* Ax, float* r, int first, int last) {
  for (std::int64_t k = 4 * static_cast<std::int64_t>(first); k < 4 * static_cast<std::int64_t>(last); k += 4) {
    FourDouble right, image;
    take(b + k, right);
    take(Ax + k, image);
    store(r + k, __builtin_convertvector(by * (right - image), Four));
  }
}

void correct(double by, const float* d, double* x, int first, int last) {
  for (std::int64_t k = 4 * static_cast<std::int64_t>(first); k < 4 * static_cast<std::int64_t>(last); k += 4) {
    FourDouble point, change = __builtin_convertvector(load(d + k), FourDouble);
    take(x + k, point);
    put(x + k, point + by * change);
  }
}

// By cofactors, eight nodes in lanes.  Positive definite exactly when the leading minors are (Sylvester).
bool invert_diagonal(const double* values, const int* slot, double scale, float* inverse, int first, int last) {
  bool definite = true;
  for (int from = first; from < last; from += 8) {
    const int count = last - from < 8 ? last - from : 8;
    double xx[8], xy[8], xz[8], yy[8], yz[8], zz[8], out[6][8];
    int good[8];
    for (int l = 0; l < 8; ++l) {
      const int node = from + (l < count ? l : 0);
      const double* b = values + 9 * static_cast<std::int64_t>(slot[node]);
      xx[l] = b[0];
      xy[l] = b[1];
      xz[l] = b[2];
      yy[l] = b[4];
      yz[l] = b[5];
      zz[l] = b[8];
    }
    for (int l = 0; l < 8; ++l) {
      const double a = yy[l] * zz[l] - yz[l] * yz[l], b = xz[l] * yz[l] - xy[l] * zz[l], c = xy[l] * yz[l] - xz[l] * yy[l];
      const double minor = xx[l] * yy[l] - xy[l] * xy[l], det = xx[l] * a + xy[l] * b + xz[l] * c, by = 1.0 / (scale * det);
      good[l] = xx[l] > 0.0 && minor > 0.0 && det > 0.0;
      out[0][l] = a * by;
      out[1][l] = b * by;
      out[2][l] = c * by;
      out[3][l] = (xx[l] * zz[l] - xz[l] * xz[l]) * by;
      out[4][l] = (xy[l] * xz[l] - xx[l] * yz[l]) * by;
      out[5][l] = minor * by;
    }
    for (int l = 0; l < count; ++l) {
      definite = definite && good[l] != 0;
      float* J = inverse + inverse_place(from + l);
      for (int axis = 0; axis < 3; ++axis) {
        J[axis] = static_cast<float>(out[axis == 0 ? 0 : axis == 1 ? 3 : 5][l]);
        J[kToOffDiagonal + axis] = static_cast<float>(out[axis == 0 ? 4 : axis == 1 ? 2 : 1][l]);
      }
      J[3] = J[kToOffDiagonal + 3] = 0.0f;
    }
  }
  return definite;
}

#undef PALPATE_INLINE
#undef PALPATE_INLINE_MEMBER

}  // namespace PALPATE_SET
}  // namespace
}  // namespace palpate::integrate

#define PALPATE_KERNELS_OF(set)                                                                                                              \
  {#set, set::product, set::pack, set::balance, set::multiply, set::multiply_balanced, set::update, set::jacobi, set::gather_rigid, set::direction, set::dense, set::invert, set::convert, set::multiply_double, set::gram, set::combine, set::difference, set::residual, \
   set::correct, set::invert_diagonal}
