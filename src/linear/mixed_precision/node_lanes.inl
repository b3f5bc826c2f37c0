// Part of node_kernels.inl: vector types, and the transposition between the numbers of a node and one
// number of many nodes.

typedef float Four __attribute__((vector_size(16)));
typedef float FourAnywhere __attribute__((vector_size(16), aligned(4), may_alias));
typedef int FourIndex __attribute__((vector_size(16)));
typedef float Wide __attribute__((vector_size(4 * PALPATE_LANES)));
typedef float WideAnywhere __attribute__((vector_size(4 * PALPATE_LANES), aligned(4), may_alias));
typedef float WideInMemory __attribute__((vector_size(4 * PALPATE_LANES), may_alias));
typedef double FourDouble __attribute__((vector_size(32)));
typedef double TwoDoubleAnywhere __attribute__((vector_size(16), aligned(8), may_alias));
typedef double EightDouble __attribute__((vector_size(64), aligned(8), may_alias));
typedef float Eight __attribute__((vector_size(32)));
typedef float EightAnywhere __attribute__((vector_size(32), aligned(4), may_alias));
typedef double FourDoubleAnywhere __attribute__((vector_size(32), aligned(8), may_alias));

PALPATE_INLINE Four load(const float* p) { return *reinterpret_cast<const FourAnywhere*>(p); }
PALPATE_INLINE void store(float* p, Four v) { *reinterpret_cast<FourAnywhere*>(p) = v; }
PALPATE_INLINE double sum(Four v) {
  return (static_cast<double>(v[0]) + v[1]) + (static_cast<double>(v[2]) + v[3]);
}

// Prefetch distances. The hardware prefetcher stops at every 4 KiB page, so the blocks of a product are
// prefetched this many numbers ahead, and blocks of the original matrix, which are in another order, some
// rows ahead.
constexpr int kFloatsAhead = 1024, kBlocksAhead = 24;

// Four neighbouring lanes hold the four numbers of one node, or one number of four nodes. The transposition
// between the two is done in all quarters of a vector at once.

typedef int WideIndex __attribute__((vector_size(4 * PALPATE_LANES)));
constexpr int kLanes = PALPATE_LANES, kParts = kLanesOfGroup / kLanes;

#if PALPATE_LANES == 16
#define PALPATE_IN_QUARTERS(a, b, c, d) \
  a, b, c, d, a + 4, b + 4, c + 4, d + 4, a + 8, b + 8, c + 8, d + 8, a + 12, b + 12, c + 12, d + 12
#define PALPATE_REPEATED(a, b, c, d) a, b, c, d, a, b, c, d, a, b, c, d, a, b, c, d
#elif PALPATE_LANES == 8
#define PALPATE_IN_QUARTERS(a, b, c, d) a, b, c, d, a + 4, b + 4, c + 4, d + 4
#define PALPATE_REPEATED(a, b, c, d) a, b, c, d, a, b, c, d
#else
#define PALPATE_IN_QUARTERS(a, b, c, d) a, b, c, d
#endif
PALPATE_INLINE Wide low(const Wide& a, const Wide& b) {
  return __builtin_shufflevector(a, b, PALPATE_IN_QUARTERS(0, kLanes, 1, kLanes + 1));
}
PALPATE_INLINE Wide high(const Wide& a, const Wide& b) {
  return __builtin_shufflevector(a, b, PALPATE_IN_QUARTERS(2, kLanes + 2, 3, kLanes + 3));
}
PALPATE_INLINE Wide low_pairs(const Wide& a, const Wide& b) {
  return __builtin_shufflevector(a, b, PALPATE_IN_QUARTERS(0, 1, kLanes, kLanes + 1));
}
PALPATE_INLINE Wide high_pairs(const Wide& a, const Wide& b) {
  return __builtin_shufflevector(a, b, PALPATE_IN_QUARTERS(2, 3, kLanes + 2, kLanes + 3));
}

/// Loads four numbers each from at[0], at[4], ... into consecutive lanes.
PALPATE_INLINE Wide every_fourth(const float* field, const int* at) {
#if PALPATE_LANES == 4
  return load(field + at[0]);
#else
  const Eight front =
      __builtin_shufflevector(load(field + at[0]), load(field + at[4]), 0, 1, 2, 3, 4, 5, 6, 7);
#if PALPATE_LANES == 8
  return front;
#else
  const Eight back =
      __builtin_shufflevector(load(field + at[8]), load(field + at[12]), 0, 1, 2, 3, 4, 5, 6, 7);
  return __builtin_shufflevector(front, back, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
#endif
#endif
}

struct Lanes3 {
  Wide x, y, z;
};
/// Loads field[at[l]], field[at[l] + 1], field[at[l] + 2] into lane l of x, y, z.
PALPATE_INLINE void gather(const float* field, const int* at, Lanes3& v) {
  const Wide a = every_fourth(field, at), b = every_fourth(field, at + 1), c = every_fourth(field, at + 2),
             d = every_fourth(field, at + 3);
  const Wide ab = low(a, b), cd = low(c, d);
  v.x = low_pairs(ab, cd);
  v.y = high_pairs(ab, cd);
  v.z = low_pairs(high(a, b), high(c, d));
}
template <int kQuarter>
PALPATE_INLINE Four quarter(const Wide& v) {
  return __builtin_shufflevector(v, v, 4 * kQuarter, 4 * kQuarter + 1, 4 * kQuarter + 2, 4 * kQuarter + 3);
}
/// Inverse of gather(): calls put(lane, x y z 0) for each lane.
template <class Put>
PALPATE_INLINE void each_lane(const Lanes3& v, Put&& put) {
  const Wide none{}, xy = low(v.x, v.y), z = low(v.z, none), xy_high = high(v.x, v.y),
                     z_high = high(v.z, none);
  const Wide rows[4] = {low_pairs(xy, z), high_pairs(xy, z), low_pairs(xy_high, z_high),
                        high_pairs(xy_high, z_high)};
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
  each_lane(
      v, [&](int lane, const Four& three)
             __attribute__((always_inline)) { store(field + at[lane], load(field + at[lane]) + three); });
}
PALPATE_INLINE void scatter_subtract(float* field, const int* at, const Lanes3& v) {
  each_lane(
      v, [&](int lane, const Four& three)
             __attribute__((always_inline)) { store(field + at[lane], load(field + at[lane]) - three); });
}
PALPATE_INLINE Lanes3 operator-(const Lanes3& a, const Lanes3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
PALPATE_INLINE Lanes3 operator+(const Lanes3& a, const Lanes3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
