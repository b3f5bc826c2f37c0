// A part of node_kernels.inl: starts from earlier solutions, and the way between an iteration in single precision and its problem in double.

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
