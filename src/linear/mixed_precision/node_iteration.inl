// Part of node_kernels.inl: operations of an iteration other than the matrix product, on vectors over the
// nodes and on the dense matrix of the clusters.

// Operations on as many nodes as fit a vector register; nodes before and after an aligned range, one by one.

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
  PALPATE_INLINE_MEMBER static Four fourth(const Four& v) {
    return __builtin_shufflevector(v, v, 3, 3, 3, 3);
  }
};
#if PALPATE_LANES > 4
template <>
struct NodesAtATime<PALPATE_LANES> {
  using Numbers = Wide;
  static constexpr int kNodes = PALPATE_LANES / 4;
  PALPATE_INLINE_MEMBER static Wide take(const float* p) { return *reinterpret_cast<const WideAnywhere*>(p); }
  PALPATE_INLINE_MEMBER static void put(float* p, const Wide& v) { *reinterpret_cast<WideAnywhere*>(p) = v; }
  PALPATE_INLINE_MEMBER static Wide spread(const Four& v) {
    return __builtin_shufflevector(v, v, PALPATE_REPEATED(0, 1, 2, 3));
  }
  PALPATE_INLINE_MEMBER static Wide yzx(const Wide& v) {
    return __builtin_shufflevector(v, v, PALPATE_IN_QUARTERS(1, 2, 0, 3));
  }
  PALPATE_INLINE_MEMBER static Wide zxy(const Wide& v) {
    return __builtin_shufflevector(v, v, PALPATE_IN_QUARTERS(2, 0, 1, 3));
  }
  PALPATE_INLINE_MEMBER static Wide fourth(const Wide& v) {
    return __builtin_shufflevector(v, v, PALPATE_IN_QUARTERS(3, 3, 3, 3));
  }
};
#endif
/// Calls work(NodesAtATime, first node) over [first, last); groups of nodes begin at a multiple of their
/// size.
template <class Work>
PALPATE_INLINE void over_nodes(int first, int last, Work&& work) {
  using One = NodesAtATime<4>;
  using Several = NodesAtATime<PALPATE_LANES>;
  int i = first;
  for (; i < last && i % Several::kNodes != 0; ++i) work(One{}, i);
  for (; i + Several::kNodes <= last; i += Several::kNodes) work(Several{}, i);
  for (; i < last; ++i) work(One{}, i);
}
/// Sum over nodes of four numbers per node, for one node or several at a time.
struct SumOverNodes {
  Four one{};
  Wide several{};
  PALPATE_INLINE_MEMBER void add(NodesAtATime<4>, const Four& v) { one += v; }
#if PALPATE_LANES > 4
  PALPATE_INLINE_MEMBER void add(NodesAtATime<PALPATE_LANES>, const Wide& v) { several += v; }
#endif
  PALPATE_INLINE_MEMBER Four four() const {
    Four total = one;
    for (int l = 0; l < kLanes; l += 4)
      total += Four{several[l], several[l + 1], several[l + 2], several[l + 3]};
    return total;
  }
  PALPATE_INLINE_MEMBER double all() const {
    double total = sum(one);
    for (int l = 0; l < kLanes; l += 4)
      total += sum(Four{several[l], several[l + 1], several[l + 2], several[l + 3]});
    return total;
  }
};

template <class N>
PALPATE_INLINE typename N::Numbers cross(N, const typename N::Numbers& a, const typename N::Numbers& b) {
  return N::yzx(a * N::yzx(b) - N::yzx(a) * b);
}
/// D r in three products: (xx yy zz) (x y z), (xy yz xz) (y z x) and (xz xy yz) (z x y).
template <class N>
PALPATE_INLINE typename N::Numbers times_inverse(N, const float* inverse, int i,
                                                 const typename N::Numbers& r) {
  const float* J = inverse + inverse_place(i);
  const auto off = N::take(J + kToOffDiagonal);
  return N::take(J) * r + N::zxy(off) * N::yzx(r) + N::yzx(off) * N::zxy(r);
}

double update(float a, const float* q, const float* inverse, float* r, float* z, int first, int last) {
  SumOverNodes rz;
  over_nodes(
      first, last, [&](auto n, int i) __attribute__((always_inline)) {
        using N = decltype(n);
        const auto residual = N::take(r + 4 * i) - a * N::take(q + 4 * i),
                   image = times_inverse(n, inverse, i, residual);
        N::put(r + 4 * i, residual);
        N::put(z + 4 * i, image);
        rz.add(n, residual * image);
      });
  return rz.all();
}

double jacobi(const float* inverse, const float* r, float* z, int first, int last) {
  SumOverNodes rz;
  over_nodes(
      first, last, [&](auto n, int i) __attribute__((always_inline)) {
        using N = decltype(n);
        const auto residual = N::take(r + 4 * i), image = times_inverse(n, inverse, i, residual);
        N::put(z + 4 * i, image);
        rz.add(n, residual * image);
      });
  return rz.all();
}

void gather_rigid(const float* r, const float* arm, float* y, int first, int last) {
  SumOverNodes force, moment;
  over_nodes(
      first, last, [&](auto n, int i) __attribute__((always_inline)) {
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

/// Calls follow(nodes, i, z + rigid motion) for each node.
template <class Follow>
PALPATE_INLINE void with_motion(const float* z, const float* arm, const float* motion, int first, int last,
                                Follow&& follow) {
  if (!motion)
    return over_nodes(
        first, last, [&](auto n, int i) __attribute__((always_inline)) {
          follow(n, i, decltype(n)::take(z + 4 * i));
        });
  const Four shift{motion[0], motion[1], motion[2], 0.0f}, turn{motion[3], motion[4], motion[5], 0.0f};
  over_nodes(
      first, last, [&](auto n, int i) __attribute__((always_inline)) {
        using N = decltype(n);
        const auto at = N::take(arm + 4 * i);
        follow(n, i, N::take(z + 4 * i) + N::fourth(at) * N::spread(shift) + cross(n, N::spread(turn), at));
      });
}

void direction(float a, float b, const float* z, const float* arm, const float* motion, float* d, float* p,
               int first, int last) {
  with_motion(
      z, arm, motion, first, last, [&](auto n, int i, const auto& next) __attribute__((always_inline)) {
        using N = decltype(n);
        const auto before = N::take(p + 4 * i);
        N::put(d + 4 * i, N::take(d + 4 * i) + a * before);
        N::put(p + 4 * i, next + b * before);
      });
}

void first_direction(const float* z, const float* arm, const float* motion, float* d, float* p, int first,
                     int last) {
  with_motion(
      z, arm, motion, first, last, [&](auto n, int i, const auto& next) __attribute__((always_inline)) {
        using N = decltype(n);
        N::put(d + 4 * i, typename N::Numbers{});
        N::put(p + 4 * i, next);
      });
}

void dense(const float* E, int stride, const float* y, float* w, int first, int last) {
  for (int i = first; i < last; ++i) {
    const float* row = E + static_cast<std::int64_t>(i) * stride;
    Wide even{}, odd{};
    int j = 0;
    for (; j + 2 * PALPATE_LANES <= stride; j += 2 * PALPATE_LANES) {
      even += *reinterpret_cast<const WideAnywhere*>(row + j) * *reinterpret_cast<const WideAnywhere*>(y + j);
      odd += *reinterpret_cast<const WideAnywhere*>(row + j + PALPATE_LANES) *
             *reinterpret_cast<const WideAnywhere*>(y + j + PALPATE_LANES);
    }
    for (; j < stride; j += PALPATE_LANES)
      even += *reinterpret_cast<const WideAnywhere*>(row + j) * *reinterpret_cast<const WideAnywhere*>(y + j);
    even += odd;
    float total = 0.0f;
    for (int l = 0; l < PALPATE_LANES; ++l) total += even[l];
    w[i] = total;
  }
}

// Gauss-Jordan elimination without pivoting, which a positive definite matrix does not need: sweep k
// exchanges unknown k with right-hand side k.
bool invert(float* E, int size, int stride) {
  for (int k = 0; k < size; ++k) {
    float* pivot_row = E + static_cast<std::int64_t>(k) * stride;
    const float pivot = pivot_row[k];
    if (!(pivot > 0.0f)) return false;
    const float inverse = 1.0f / pivot;
    pivot_row[k] = 1.0f;
    for (int j = 0; j < stride; j += PALPATE_LANES)
      *reinterpret_cast<WideAnywhere*>(pivot_row + j) *= inverse;
    for (int i = 0; i < size; ++i) {
      if (i == k) continue;
      float* row = E + static_cast<std::int64_t>(i) * stride;
      const float factor = row[k];
      if (factor == 0.0f) continue;
      row[k] = 0.0f;
      for (int j = 0; j < stride; j += PALPATE_LANES)
        *reinterpret_cast<WideAnywhere*>(row + j) -=
            factor * *reinterpret_cast<const WideAnywhere*>(pivot_row + j);
    }
  }
  for (int i = 0; i < size; ++i)  // remove the asymmetry of rounding
    for (int j = 0; j < i; ++j) {
      float &low = E[static_cast<std::int64_t>(i) * stride + j],
            &high = E[static_cast<std::int64_t>(j) * stride + i];
      low = high = 0.5f * (low + high);
    }
  return true;
}
