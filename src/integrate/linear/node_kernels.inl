// The kernels of node_kernels.h for one instruction set: PALPATE_SET names it, PALPATE_LANES is its width in floats (4, 8, 16).
// Nothing here calls a function of a library: an inline one, compiled for this set, could be linked into code for another.

#include "integrate/linear/node_kernels.h"

namespace palpate::integrate {
namespace {
namespace PALPATE_SET {

#define PALPATE_INLINE [[gnu::always_inline]] static inline

typedef float Four __attribute__((vector_size(16)));
typedef float FourAnywhere __attribute__((vector_size(16), aligned(4), may_alias));
typedef int FourIndex __attribute__((vector_size(16)));
typedef float Wide __attribute__((vector_size(4 * PALPATE_LANES)));
typedef float WideAnywhere __attribute__((vector_size(4 * PALPATE_LANES), aligned(4), may_alias));
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
PALPATE_INLINE Four cross(Four a, Four b) {
  const FourIndex yzx{1, 2, 0, 3};
  return __builtin_shuffle(a * __builtin_shuffle(b, yzx) - __builtin_shuffle(a, yzx) * b, yzx);
}

// A processor's own guess of what is read next ends at every page of 4 KiB: the blocks of a product are asked for two kilobytes before, those of the original,
// which stand in another order, some rows before.
constexpr int kFloatsAhead = 512, kBlocksAhead = 24;

#if PALPATE_LANES == 16

// One vector holds a block: lane 3 c + r is B(r, c), and what follows in memory (the next block) meets the zero in p's fourth entry.
typedef int WideIndex __attribute__((vector_size(64)));

/// x x x y y y z z z 0 ... of a node: sixteen bytes are read, which never lie on two lines.  (GCC 12 takes the way through memory for the same in vector types.)
PALPATE_INLINE Wide spread(const float* p) {
  Wide all;
  __asm__("vbroadcastf32x4 %1, %0" : "=v"(all) : "m"(*reinterpret_cast<const FourAnywhere*>(p)));
  return __builtin_shuffle(all, WideIndex{0, 0, 0, 1, 5, 5, 6, 6, 10, 11, 11, 11, 15, 15, 15, 15});
}
PALPATE_INLINE Wide block_at(const SingleBlocks& A, int s) { return *reinterpret_cast<const WideAnywhere*>(A.values + 9 * static_cast<std::int64_t>(s)); }

PALPATE_INLINE Four row_product(const SingleBlocks& A, const float* p, int i) {
  Wide even{}, odd{};
  int s = A.row_start[i];
  const int end = A.row_start[i + 1];
  for (; s + 1 < end; s += 2) {
    __builtin_prefetch(A.values + 9 * static_cast<std::int64_t>(s) + kFloatsAhead);
    even += block_at(A, s) * spread(p + 4 * A.column[s]);
    odd += block_at(A, s + 1) * spread(p + 4 * A.column[s + 1]);
  }
  if (s < end) even += block_at(A, s) * spread(p + 4 * A.column[s]);
  even += odd;
  const WideIndex second{3, 4, 5, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9}, third{6, 7, 8, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9, 9};
  const Wide all = even + __builtin_shuffle(even, second) + __builtin_shuffle(even, third);
  return without_last(__builtin_shufflevector(all, all, 0, 1, 2, 3));
}

#else

PALPATE_INLINE Four row_product(const SingleBlocks& A, const float* p, int i) {
  Four first{}, second{}, third{};
  for (int s = A.row_start[i]; s < A.row_start[i + 1]; ++s) {
    const float *block = A.values + 9 * static_cast<std::int64_t>(s), *x = p + 4 * A.column[s];
    __builtin_prefetch(block + kFloatsAhead);
    first += load(block) * splat(x[0]);
    second += load(block + 3) * splat(x[1]);
    third += load(block + 6) * splat(x[2]);
  }
  return without_last(first + second + third);
}

#endif

double product(const SingleBlocks& A, const float* p, float* q, int first, int last) {
  Four pq{};
  for (int i = first; i < last; ++i) {
    const Four row = row_product(A, p, i);
    store(q + 4 * i, row);
    pq += load(p + 4 * i) * row;
  }
  return sum(pq);
}

PALPATE_INLINE Four times_inverse(const float* inverse, int i, Four r) {
  const float* J = inverse + kInverseStride * static_cast<std::int64_t>(i);
  return load(J) * splat(r[0]) + load(J + 4) * splat(r[1]) + load(J + 8) * splat(r[2]);
}

double update(float a, const float* p, const float* q, const float* inverse, float* d, float* r, float* z, int first, int last) {
  Four rz{};
  for (int i = first; i < last; ++i) {
    store(d + 4 * i, load(d + 4 * i) + splat(a) * load(p + 4 * i));
    const Four residual = load(r + 4 * i) - splat(a) * load(q + 4 * i), image = times_inverse(inverse, i, residual);
    store(r + 4 * i, residual);
    store(z + 4 * i, image);
    rz += residual * image;
  }
  return sum(rz);
}

double jacobi(const float* inverse, const float* r, float* z, int first, int last) {
  Four rz{};
  for (int i = first; i < last; ++i) {
    const Four residual = load(r + 4 * i), image = times_inverse(inverse, i, residual);
    store(z + 4 * i, image);
    rz += residual * image;
  }
  return sum(rz);
}

void gather_rigid(const float* r, const float* arm, float* y, int first, int last) {
  Four force{}, moment{};
  for (int i = first; i < last; ++i) {
    const Four a = load(arm + 4 * i), residual = splat(a[3]) * load(r + 4 * i);
    force += residual;
    moment += cross(a, residual);
  }
  for (int axis = 0; axis < 3; ++axis) {
    y[axis] = force[axis];
    y[3 + axis] = moment[axis];
  }
}

void direction(float b, const float* z, const float* arm, const float* motion, float* p, int first, int last) {
  if (!motion) {
    for (int i = first; i < last; ++i) store(p + 4 * i, load(z + 4 * i) + splat(b) * load(p + 4 * i));
    return;
  }
  const Four shift{motion[0], motion[1], motion[2], 0.0f}, turn{motion[3], motion[4], motion[5], 0.0f};
  for (int i = first; i < last; ++i) {
    const Four a = load(arm + 4 * i);
    store(p + 4 * i, load(z + 4 * i) + splat(a[3]) * shift + cross(turn, a) + splat(b) * load(p + 4 * i));
  }
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

/// work(Count<n>) for n columns: their sums stay in registers.
template <int N>
struct Count {
  static constexpr int value = N;
};
template <class Work>
[[gnu::always_inline]] static inline auto by_count(int count, Work&& work) {
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
[[gnu::always_inline]] static inline bool convert_columns(const DoubleBlocks& A, double scale, float* out, const double* const* V, double* const* AV, int first, int last) {
  Eight probe{};  // 0 x is no number where x is infinite or none
  float probe_last = 0.0f;
  const int end_of_all = A.row_start[last];
  for (int i = first; i < last; ++i) {
    FourDouble total[3 * N + 1] = {};
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
      if (out) {
        float* to = out + 9 * static_cast<std::int64_t>(s);
        const Eight rows = __builtin_convertvector(*reinterpret_cast<const EightDouble*>(block) * scale, Eight);
        *reinterpret_cast<EightAnywhere*>(to) = __builtin_shufflevector(rows, rows, 0, 3, 6, 1, 4, 7, 2, 5);
        to[8] = static_cast<float>(scale * block[8]);
        probe += rows * 0.0f;
        probe_last += to[8] * 0.0f;
      }
      for (int n = 0; n < N; ++n) {
        const FourDouble x = *reinterpret_cast<const FourDoubleAnywhere*>(V[n] + 4 * static_cast<std::int64_t>(A.column[s]));
        for (int r = 0; r < 3; ++r) total[3 * n + r] += *reinterpret_cast<const FourDoubleAnywhere*>(block + 3 * r) * x;
      }
    }
    for (int n = 0; n < N; ++n) {
      double* y = AV[n] + 4 * static_cast<std::int64_t>(i);
      for (int r = 0; r < 3; ++r) y[r] = sum3(total[3 * n + r]);
      y[3] = 0.0;
    }
  }
  for (int l = 0; l < 8; ++l) probe_last += probe[l];
  return probe_last == 0.0f;
}

bool convert(const DoubleBlocks& A, double scale, float* out, int count, const double* const* V, double* const* AV, int first, int last) {
  return by_count(count, [&](auto n) __attribute__((always_inline)) { return convert_columns<decltype(n)::value>(A, scale, out, V, AV, first, last); });
}

// By reference: a vector wider than the baseline's registers is no return value.
PALPATE_INLINE void take_column(const float* column, FourDouble& out) { out = __builtin_convertvector(load(column), FourDouble); }
PALPATE_INLINE void take_column(const double* column, FourDouble& out) { out = *reinterpret_cast<const FourDoubleAnywhere*>(column); }

template <int N, bool kBalance>
[[gnu::always_inline]] static inline bool balanced_columns(const BalancedBlocks& A, const double* const* V, double* const* AV, int first, int last) {
  FourDouble probe{};
  for (int i = first; i < last; ++i) {
    FourDouble sum[3] = {}, total[N + 1] = {};
    for (int s = A.row_start[i] + 1; s < A.row_start[i + 1]; ++s) {
      const float* block = A.values + 9 * static_cast<std::int64_t>(s);
      __builtin_prefetch(block + kFloatsAhead);
      FourDouble x, y, z;
      take_column(block, x);
      take_column(block + 3, y);
      take_column(block + 6, z);
      if constexpr (kBalance) {
        sum[0] += x;
        sum[1] += y;
        sum[2] += z;
      }
      for (int n = 0; n < N; ++n) {
        const double* v = V[n] + 4 * static_cast<std::int64_t>(A.column[s]);
        total[n] += x * v[0] + y * v[1] + z * v[2];
      }
    }
    double* own = A.own + 9 * static_cast<std::int64_t>(i);
    if constexpr (kBalance) {
      const double* m = A.mass + 4 * static_cast<std::int64_t>(i);
      float* single = A.values + 9 * static_cast<std::int64_t>(A.row_start[i]);
      for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) own[3 * c + r] = (r == c ? m[c] : 0.0) - sum[c][r];
      for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) single[3 * c + r] = static_cast<float>(0.5 * (own[3 * c + r] + own[3 * r + c]));
      for (int c = 0; c < 3; ++c) probe += sum[c] * 0.0;  // 0 x is no number where x is infinite or none
    }
    FourDouble x, y, z;
    take_column(own, x);
    take_column(own + 3, y);
    take_column(own + 6, z);
    for (int n = 0; n < N; ++n) {
      const double* v = V[n] + 4 * static_cast<std::int64_t>(i);
      total[n] = (total[n] + x * v[0] + y * v[1] + z * v[2]) * A.unit;
      double* to = AV[n] + 4 * static_cast<std::int64_t>(i);
      for (int r = 0; r < 3; ++r) to[r] = total[n][r];
      to[3] = 0.0;
    }
  }
  return sum3(probe) == 0.0;
}

template <bool kBalance>
static bool balanced_rows(const BalancedBlocks& A, int count, const double* const* V, double* const* AV, int first, int last) {
  return by_count(count, [&](auto n) __attribute__((always_inline)) { return balanced_columns<decltype(n)::value, kBalance>(A, V, AV, first, last); });
}
bool balance(const BalancedBlocks& A, int count, const double* const* V, double* const* AV, int first, int last) {
  return balanced_rows<true>(A, count, V, AV, first, last);
}
void multiply_balanced(const BalancedBlocks& A, int count, const double* const* V, double* const* AV, int first, int last) {
  balanced_rows<false>(A, count, V, AV, first, last);
}

PALPATE_INLINE void take(const double* p, FourDouble& out) { out = *reinterpret_cast<const FourDoubleAnywhere*>(p); }
PALPATE_INLINE void put(double* p, const FourDouble& v) { *reinterpret_cast<FourDoubleAnywhere*>(p) = v; }

template <int N>
[[gnu::always_inline]] static inline void gram_of(const double* const* V, const double* const* AV, const double* b, int first, int last, double* out) {
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
void gram(int count, const double* const* V, const double* const* AV, const double* b, int first, int last, double* out) {
  by_count(count, [&](auto n) __attribute__((always_inline)) { gram_of<decltype(n)::value>(V, AV, b, first, last, out); });
}

template <int N>
[[gnu::always_inline]] static inline double combine_of(const double* y, const double* const* V, const double* const* AV, const double* b, double* x, double* Ax, int first,
                                                       int last) {
  FourDouble square{};
  for (std::int64_t k = 4 * static_cast<std::int64_t>(first); k < 4 * static_cast<std::int64_t>(last); k += 4) {
    FourDouble point{}, image{}, right, v;
    for (int n = 0; n < N; ++n) {
      take(V[n] + k, v);
      point += y[n] * v;
      take(AV[n] + k, v);
      image += y[n] * v;
    }
    put(x + k, point);
    put(Ax + k, image);
    take(b + k, right);
    right -= image;
    square += right * right;
  }
  return sum3(square);
}
double combine(int count, const double* y, const double* const* V, const double* const* AV, const double* b, double* x, double* Ax, int first, int last) {
  return by_count(count, [&](auto n) __attribute__((always_inline)) { return combine_of<decltype(n)::value>(y, V, AV, b, x, Ax, first, last); });
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
      const double* b = values + 9 * static_cast<std::int64_t>(slot ? slot[node] : node);
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
      float* J = inverse + kInverseStride * static_cast<std::int64_t>(from + l);
      J[0] = static_cast<float>(out[0][l]);
      J[1] = J[4] = static_cast<float>(out[1][l]);
      J[2] = J[8] = static_cast<float>(out[2][l]);
      J[5] = static_cast<float>(out[3][l]);
      J[6] = J[9] = static_cast<float>(out[4][l]);
      J[10] = static_cast<float>(out[5][l]);
      J[3] = J[7] = J[11] = 0.0f;
    }
  }
  return definite;
}

#undef PALPATE_INLINE

}  // namespace PALPATE_SET
}  // namespace
}  // namespace palpate::integrate

#define PALPATE_KERNELS_OF(set)                                                                                                              \
  {#set, set::product, set::update, set::jacobi, set::gather_rigid, set::direction, set::dense, set::invert, set::convert, set::balance, set::multiply_balanced, set::gram, set::combine, set::residual, \
   set::correct, set::invert_diagonal}
