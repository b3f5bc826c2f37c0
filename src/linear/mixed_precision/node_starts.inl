// Part of node_kernels.inl: initial guesses from earlier solutions, and transfers between an iteration in
// single precision and its problem in double.

PALPATE_INLINE void take(const float* p, FourDouble& out) {
  out = __builtin_convertvector(load(p), FourDouble);
}
PALPATE_INLINE void take(const double* p, FourDouble& out) {
  out = *reinterpret_cast<const FourDoubleAnywhere*>(p);
}
PALPATE_INLINE void put(double* p, const FourDouble& v) { *reinterpret_cast<FourDoubleAnywhere*>(p) = v; }

template <int N>
[[gnu::always_inline]] static inline void gram_of(const double* y, const float* const* V,
                                                  const float* const* AV, const double* b, int first,
                                                  int last, double* out) {
  constexpr auto kVectors = static_cast<std::size_t>(N + 1);
  FourDouble sum[kMostSums] = {}, square{};
  for (std::int64_t k = 4 * static_cast<std::int64_t>(first); k < 4 * static_cast<std::int64_t>(last);
       k += 4) {
    FourDouble v[kVectors], Av[kVectors], right;
    for (int n = 0; n < N; ++n) {
      take(V[n] + k, v[n]);
      take(AV[n] + k, Av[n]);
    }
    take(b + k, right);
    int at = 0;
    for (int j = 0; j < N; ++j)
      for (int i = 0; i <= j; ++i) sum[at++] += v[j] * Av[i];
    for (int j = 0; j < N; ++j) sum[at++] += v[j] * right;
    for (int n = 0; n < N; ++n) right -= y[n] * Av[n];
    square += right * right;
  }
  constexpr int kSums = N * (N + 1) / 2 + N;
  for (int at = 0; at < kSums; ++at) out[at] = sum3(sum[at]);
  out[kSums] = sum3(square);
}
void gram(int count, const double* y, const float* const* V, const float* const* AV, const double* b,
          int first, int last, double* out) {
  by_count(
      count, [&](auto n) __attribute__((always_inline)) {
        gram_of<decltype(n)::value>(y, V, AV, b, first, last, out);
      });
}

template <int N>
[[gnu::always_inline]] static inline void combine_of(const double* y, const float* const* V, double* x,
                                                     int first, int last) {
  double* to = x;
  for (std::int64_t k = 4 * static_cast<std::int64_t>(first); k < 4 * static_cast<std::int64_t>(last);
       k += 4, to += 4) {
    FourDouble sum{}, v;
    for (int n = 0; n < N; ++n) {
      take(V[n] + k, v);
      sum += y[n] * v;
    }
    put(to, sum);
  }
}
void combine(int count, const double* y, const float* const* V, double* x, int first, int last) {
  by_count(
      count, [&](auto n)
                 __attribute__((always_inline)) { combine_of<decltype(n)::value>(y, V, x, first, last); });
}

template <int N>
[[gnu::always_inline]] static inline void leave_of(const double* y, double by, const float* const* AV,
                                                   const double* b, float* r, int first, int last) {
  for (std::int64_t k = 4 * static_cast<std::int64_t>(first); k < 4 * static_cast<std::int64_t>(last);
       k += 4) {
    FourDouble left, image;
    take(b + k, left);
    for (int n = 0; n < N; ++n) {
      take(AV[n] + k, image);
      left -= y[n] * image;
    }
    store(r + k, __builtin_convertvector(by * left, Four));
  }
}
void leave(int count, const double* y, double by, const float* const* AV, const double* b, float* r,
           int first, int last) {
  by_count(
      count, [&](auto n) __attribute__((always_inline)) {
        leave_of<decltype(n)::value>(y, by, AV, b, r, first, last);
      });
}

template <int N>
[[gnu::always_inline]] static inline void difference_of(double by, double change, const double* x,
                                                        float* const* V, int first, int last) {
  const double* from = x;
  for (std::int64_t k = 4 * static_cast<std::int64_t>(first); k < 4 * static_cast<std::int64_t>(last);
       k += 4, from += 4) {
    FourDouble value, old;
    take(from, value);
    value *= by;
    for (int n = 0; n < N; ++n) {
      take(V[n] + k, old);
      store(V[n] + k, __builtin_convertvector(value, Four));
      value -= change * old;
    }
  }
}
void difference(int count, double by, double change, const double* x, float* const* V, int first, int last) {
  by_count(
      count, [&](auto n) __attribute__((always_inline)) {
        difference_of<decltype(n)::value>(by, change, x, V, first, last);
      });
}

void residual(double by, const double* b, const double* Ax, float* r, int first, int last) {
  for (std::int64_t k = 4 * static_cast<std::int64_t>(first); k < 4 * static_cast<std::int64_t>(last);
       k += 4) {
    FourDouble right, image;
    take(b + k, right);
    take(Ax + k, image);
    store(r + k, __builtin_convertvector(by * (right - image), Four));
  }
}

void image(double by, const double* b, const float* r, double* Ax, int first, int last) {
  double* to = Ax;
  for (std::int64_t k = 4 * static_cast<std::int64_t>(first); k < 4 * static_cast<std::int64_t>(last);
       k += 4, to += 4) {
    FourDouble right, left = __builtin_convertvector(load(r + k), FourDouble);
    take(b + k, right);
    put(to, right - by * left);
  }
}

void correct(double by, const float* d, float a, const float* p, double* x, int first, int last) {
  double* to = x;
  for (std::int64_t k = 4 * static_cast<std::int64_t>(first); k < 4 * static_cast<std::int64_t>(last);
       k += 4, to += 4) {
    FourDouble point, change = __builtin_convertvector(load(d + k) + a * load(p + k), FourDouble);
    take(to, point);
    put(to, point + by * change);
  }
}

// Transfers between the order here and the caller's, in which vectors have three numbers per node.

double scatter_nodes(const int* node, const double* x, double* out, int first, int last) {
  FourDouble largest{};
  const double* from = x;
  for (int k = first; k < last; ++k, from += 4) {
    FourDouble value;
    take(from, value);
    double* to = out + 3 * static_cast<std::int64_t>(node[k]);
    *reinterpret_cast<TwoDoubleAnywhere*>(to) = __builtin_shufflevector(value, value, 0, 1);
    to[2] = value[2];
    value = value < 0.0 ? -value : value;
    largest = value > largest ? value : largest;
  }
  double most = 0.0;
  for (int axis = 0; axis < 3; ++axis) most = largest[axis] > most ? largest[axis] : most;
  return most;
}

void add_nodes(const int* node, const double* in, double* x, int first, int last) {
  double* to = x;
  for (int k = first; k < last; ++k, to += 4) {
    const double* from = in + 3 * static_cast<std::int64_t>(node[k]);
    FourDouble value;
    take(to, value);
    put(to, value + FourDouble{from[0], from[1], from[2], 0.0});
  }
}
