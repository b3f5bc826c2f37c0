// Part of node_kernels.inl: products of packed rows in single precision, and the packing of blocks.

PALPATE_INLINE Wide number(const float* values, int k) {
  return *reinterpret_cast<const WideInMemory*>(values + kLanesOfGroup * k);
}

/// B v and B^T v for the blocks at `values`.
PALPATE_INLINE Lanes3 times(const float* values, const Lanes3& v) {
  return {number(values, 0) * v.x + number(values, 3) * v.y + number(values, 6) * v.z,
          number(values, 1) * v.x + number(values, 4) * v.y + number(values, 7) * v.z,
          number(values, 2) * v.x + number(values, 5) * v.y + number(values, 8) * v.z};
}
PALPATE_INLINE Lanes3 transposed_times(const float* values, const Lanes3& v) {
  return {number(values, 0) * v.x + number(values, 1) * v.y + number(values, 2) * v.z,
          number(values, 3) * v.x + number(values, 4) * v.y + number(values, 5) * v.z,
          number(values, 6) * v.x + number(values, 7) * v.y + number(values, 8) * v.z};
}

/// Q += A P for N vectors, for one part of a group; for a zero-row-sum matrix without the mass term.
template <bool kWhole, int N>
PALPATE_INLINE void add_group(const PackedRows& A, const float* const* P, float* const* Q, int group,
                              int part) {
  const int *row = A.row + kLanesOfGroup * group + kLanes * part, single = A.single_start[group],
            end = A.step_start[group + 1];
  const int* column =
      A.column + kLanesOfGroup * static_cast<std::int64_t>(A.step_start[group]) + kLanes * part;
  const float* values =
      A.values + kNumbersOfStep * static_cast<std::int64_t>(A.step_start[group]) + kLanes * part;
  constexpr auto kVectors = static_cast<std::size_t>(N);
  Lanes3 own[kVectors], sum[kVectors], v;
  for (int n = 0; n < N; ++n) {
    gather(P[n], row, own[n]);
    sum[n] = kWhole ? times(A.own + kNumbersOfStep * static_cast<std::int64_t>(group) + kLanes * part, own[n])
                    : Lanes3{};
  }
  int s = A.step_start[group];
  const auto next = [&]() __attribute__((always_inline)) {
    ++s;
    column += kLanesOfGroup;
    values += kNumbersOfStep;
    if (part == 0)
      for (int line = 0; line < kNumbersOfStep; line += 16) __builtin_prefetch(values + kFloatsAhead + line);
  };
  for (; s < single; next())
    for (int n = 0; n < N; ++n) {
      gather(P[n], column, v);
      if constexpr (!kWhole) v = v - own[n];
      sum[n] = sum[n] + times(values, v);
      if constexpr (kWhole)
        scatter_add(Q[n], column, transposed_times(values, own[n]));
      else
        scatter_subtract(Q[n], column, transposed_times(values, v));
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

/// Calls work(Count<n>) for n columns, so that their sums stay in registers.
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
    for (int n = 0; n < N; ++n)
      store(AV[n] + 4 * i, load(AV[n] + 4 * i) + load(A.mass + 4 * i) * load(V[n] + 4 * i));
}
template <int N>
PALPATE_INLINE void multiply_columns(const PackedRows& A, const float* const* V, float* const* AV) {
  if constexpr (N > 0) {
    add_groups<N>(A, V, AV);
    if (A.mass) add_mass<N>(A, V, AV);
  }
}
void multiply(const PackedRows& A, int count, const float* const* V, float* const* AV) {
  by_count(
      count, [&](auto n) __attribute__((always_inline)) { multiply_columns<decltype(n)::value>(A, V, AV); });
}

/// Prefetches the blocks of a later place in `offset`.
PALPATE_INLINE void fetch_blocks(const BlockSource& from, std::int64_t at) {
  const int* later = from.offset + kLanesOfGroup * (at + kStepsAhead);
  for (int l = 0; l < kLanesOfGroup; ++l) __builtin_prefetch(from.values + later[l]);
}
/// Loads the blocks of one part of a place in `offset`; entry (r, c) at [3 c + r].
PALPATE_INLINE void take_blocks(const BlockSource& from, std::int64_t at, int part, Wide* block) {
  const int* offset = from.offset + kLanesOfGroup * at + kLanes * part;
  for (int c = 0; c < 3; ++c) {
    Lanes3 column;
    gather(from.values + 3 * c, offset, column);
    block[3 * c] = column.x;
    block[3 * c + 1] = column.y;
    block[3 * c + 2] = column.z;
  }
  if (!from.transposed) return;
  WideIndex transposed;
  for (int l = 0; l < kLanes; ++l) transposed[l] = 1 << l;
  transposed = (transposed & (from.transposed[at] >> (kLanes * part))) != 0;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < c; ++r) {
      const Wide above = block[3 * c + r], below = block[3 * r + c];
      block[3 * c + r] = transposed ? below : above;
      block[3 * r + c] = transposed ? above : below;
    }
}
PALPATE_INLINE void put_blocks(float* values, std::int64_t step, int part, const Wide* block) {
  for (int k = 0; k < 9; ++k)
    *reinterpret_cast<WideInMemory*>(values + kNumbersOfStep * step + kLanes * part + kLanesOfGroup * k) =
        block[k];
}

void pack(const PackedRows& A, const BlockSource& from) {
  const auto move = [&](std::int64_t at, float* values, std::int64_t step) __attribute__((always_inline)) {
    fetch_blocks(from, at);
    for (int part = 0; part < kParts; ++part) {
      Wide block[9];
      take_blocks(from, at, part, block);
      put_blocks(values, step, part, block);
    }
  };
  for (std::int64_t g = A.first_group; g < A.last_group; ++g) move(g, A.own, g);
  for (std::int64_t s = A.step_start[A.first_group]; s < A.step_start[A.last_group]; ++s)
    move(A.groups + s, A.values, s);
}

/// Symmetric blocks: xx, yy, zz and yz, xz, xy.
struct Symmetric {
  Lanes3 diagonal, off;
};
PALPATE_INLINE Symmetric symmetric_part(const Wide* block) {
  return {{block[0], block[4], block[8]},
          {0.5f * (block[7] + block[5]), 0.5f * (block[6] + block[2]), 0.5f * (block[3] + block[1])}};
}

/// Inverses by cofactors of the block divided by its trace. Positive definite exactly when the leading minors
/// are positive (Sylvester).
PALPATE_INLINE WideIndex invert_own(const Symmetric& own, float* inverse, const int* row) {
  const Wide trace = own.diagonal.x + own.diagonal.y + own.diagonal.z, by = 1.0f / trace;
  const Wide xx = by * own.diagonal.x, yy = by * own.diagonal.y, zz = by * own.diagonal.z,
             yz = by * own.off.x, xz = by * own.off.y, xy = by * own.off.z;
  const Wide a = yy * zz - yz * yz, b = xz * yz - xy * zz, c = xy * yz - xz * yy;
  const Wide minor = xx * yy - xy * xy, det = xx * a + xy * b + xz * c, scale = by / det;
  const Wide d = (xx * zz - xz * xz) * scale, e = (xy * xz - xx * yz) * scale;
  const auto put = [&](int to, const Lanes3& three) __attribute__((always_inline)) {
    each_lane(
        three, [&](int lane, const Four& numbers) __attribute__((always_inline)) {
          store(inverse + inverse_place(row[lane] / 4) + to, numbers);
        });
  };
  put(0, {a * scale, d, minor * scale});
  put(kToOffDiagonal, {e, c * scale, b * scale});
  return (trace > 0.0f) & (xx > 0.0f) & (minor > 0.0f) & (det > 0.0f);
}

template <int N>
PALPATE_INLINE RowStatus complete_columns(const PackedRows& A, const BlockSource& from, float* sums,
                                          float* inverse, double* trace, const float* const* V,
                                          float* const* AV) {
  set_zero<N>(A, AV);
  float* off = sums + 4;  // eight numbers per node
  for (int i = A.first_node; i < A.last_node; ++i) {
    store(sums + 8 * i, Four{});
    store(off + 8 * i, Four{});
  }
  const auto add = [&](const int* at, const Symmetric& part) __attribute__((always_inline)) {
    each_lane(
        part.diagonal, [&](int lane, const Four& three) __attribute__((always_inline)) {
          store(sums + 2 * at[lane], load(sums + 2 * at[lane]) + three);
        });
    each_lane(
        part.off, [&](int lane, const Four& three) __attribute__((always_inline)) {
          store(off + 2 * at[lane], load(off + 2 * at[lane]) + three);
        });
  };
  for (int g = A.first_group; g < A.last_group; ++g)
    for (int part = 0; part < kParts; ++part) {
      Symmetric row{};
      for (std::int64_t s = A.step_start[g]; s < A.step_start[g + 1]; ++s) {
        Wide block[9];
        if (part == 0) fetch_blocks(from, A.groups + s);
        take_blocks(from, A.groups + s, part, block);
        put_blocks(A.values, s, part, block);
        const Symmetric middle = symmetric_part(block);
        row = {row.diagonal + middle.diagonal, row.off + middle.off};
        if (s < A.single_start[g]) add(A.column + kLanesOfGroup * s + kLanes * part, middle);
      }
      add(A.row + kLanesOfGroup * g + kLanes * part, row);
      if constexpr (N > 0) add_group<false, N>(A, V, AV, g, part);  // while the blocks are in cache
    }
  add_mass<N>(A, V, AV);
  WideIndex definite = WideIndex{} == 0;
  Wide probe{};  // 0 x is NaN where x is infinite or NaN
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
      const Wide block[9] = {own.diagonal.x, own.off.z, own.off.y, own.off.z,     own.diagonal.y,
                             own.off.x,      own.off.y, own.off.x, own.diagonal.z};
      put_blocks(A.own, g, part, block);
      definite &= invert_own(own, inverse, row);
    }
  double traces = 0.0;
  for (int i = A.first_node; i < A.last_node; ++i)
    for (int axis = 0; axis < 3; ++axis) traces += A.mass[4 * i + axis] - sums[8 * i + axis];
  *trace = traces;
  for (int l = 0; l < kLanes; ++l)
    if (!(probe[l] == 0.0f)) return RowStatus::kNotFinite;
  for (int l = 0; l < kLanes; ++l)
    if (!definite[l]) return RowStatus::kNotDefinite;
  return RowStatus::kOk;
}
RowStatus complete(const PackedRows& A, const BlockSource& from, float* sums, float* inverse, double* trace,
                   int count, const float* const* V, float* const* AV) {
  return by_count(
      count, [&](auto n) __attribute__((always_inline)) {
        return complete_columns<decltype(n)::value>(A, from, sums, inverse, trace, V, AV);
      });
}
