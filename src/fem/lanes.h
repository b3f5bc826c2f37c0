#pragma once
// Elements in SIMD lanes, by the compiler's vector types. This header and the other lane_*.h except
// lane_kernels.h are included only by lanes_*.cpp, inside the namespace of one instruction set,
// PALPATE_KERNELS, whose vectors have PALPATE_WIDTH doubles. Everything in them is static and inlined, so
// that no copy for one set is linked into another.

#define PALPATE_INLINE [[gnu::always_inline]] static inline
#define PALPATE_INLINE_MEMBER [[gnu::always_inline]]

// lanes of one vector: 2, 4 or 8; a group of eight is processed in 8 / kWidth parts
constexpr int kWidth = PALPATE_WIDTH;
typedef double Pack __attribute__((vector_size(8 * PALPATE_WIDTH)));
typedef long long Mask __attribute__((vector_size(8 * PALPATE_WIDTH)));
typedef double PackInMemory __attribute__((vector_size(8 * PALPATE_WIDTH), may_alias));

PALPATE_INLINE Pack load(const double* p) { return *reinterpret_cast<const PackInMemory*>(p); }
/// Prefetches cache lines that are needed soon (3) or later (2: into the second-level cache). The hardware
/// prefetcher stops at every 4 KiB page, which here is every 40 elements.
template <int kHowSoon>
PALPATE_INLINE void fetch(const void* first, int bytes) {
  for (int at = 0; at < bytes; at += 64)
    __builtin_prefetch(static_cast<const char*>(first) + at, 0, kHowSoon);
}
PALPATE_INLINE bool any(Mask m) {
#if PALPATE_WIDTH == 8
  return _mm512_test_epi64_mask(reinterpret_cast<__m512i&>(m), reinterpret_cast<__m512i&>(m)) != 0;
#elif PALPATE_WIDTH == 4
  return _mm256_movemask_pd(reinterpret_cast<__m256d&>(m)) != 0;
#else
  long long bits = 0;
  for (int l = 0; l < kWidth; ++l) bits |= m[l];
  return bits != 0;
#endif
}

struct Vector {
  Pack x, y, z;
};
struct Matrix {
  Vector row[3];
};

PALPATE_INLINE Vector operator+(const Vector& a, const Vector& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
PALPATE_INLINE Vector operator-(const Vector& a, const Vector& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
PALPATE_INLINE Vector operator-(const Vector& a) { return {-a.x, -a.y, -a.z}; }
PALPATE_INLINE Vector operator*(Pack s, const Vector& a) { return {s * a.x, s * a.y, s * a.z}; }
PALPATE_INLINE Pack dot(const Vector& a, const Vector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
PALPATE_INLINE Vector cross(const Vector& a, const Vector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
PALPATE_INLINE Matrix operator+(const Matrix& A, const Matrix& B) {
  return {{A.row[0] + B.row[0], A.row[1] + B.row[1], A.row[2] + B.row[2]}};
}
PALPATE_INLINE Matrix operator-(const Matrix& A, const Matrix& B) {
  return {{A.row[0] - B.row[0], A.row[1] - B.row[1], A.row[2] - B.row[2]}};
}
PALPATE_INLINE Matrix operator*(Pack s, const Matrix& A) {
  return {{s * A.row[0], s * A.row[1], s * A.row[2]}};
}
/// a^T B
PALPATE_INLINE Vector times(const Vector& a, const Matrix& B) {
  return a.x * B.row[0] + a.y * B.row[1] + a.z * B.row[2];
}
/// A b
PALPATE_INLINE Vector apply(const Matrix& A, const Vector& b) {
  return {dot(A.row[0], b), dot(A.row[1], b), dot(A.row[2], b)};
}
PALPATE_INLINE Matrix operator*(const Matrix& A, const Matrix& B) {
  return {{times(A.row[0], B), times(A.row[1], B), times(A.row[2], B)}};
}
/// A B^T
PALPATE_INLINE Matrix times_transposed(const Matrix& A, const Matrix& B) {
  return {{apply(B, A.row[0]), apply(B, A.row[1]), apply(B, A.row[2])}};
}
PALPATE_INLINE Pack double_dot(const Matrix& A, const Matrix& B) {
  return dot(A.row[0], B.row[0]) + dot(A.row[1], B.row[1]) + dot(A.row[2], B.row[2]);
}

/// cof F = det(F) F^-T, for singular F as well.
PALPATE_INLINE Matrix cofactors(const Matrix& F) {
  return {{cross(F.row[1], F.row[2]), cross(F.row[2], F.row[0]), cross(F.row[0], F.row[1])}};
}

/// Copies one lane of a matrix, row by row.
PALPATE_INLINE void take_lane(const Matrix& A, int l, double* a) {
  for (int r = 0; r < 3; ++r) {
    a[3 * r] = A.row[r].x[l];
    a[3 * r + 1] = A.row[r].y[l];
    a[3 * r + 2] = A.row[r].z[l];
  }
}
PALPATE_INLINE void put_lane(const double* a, int l, Matrix& A) {
  for (int r = 0; r < 3; ++r) {
    A.row[r].x[l] = a[3 * r];
    A.row[r].y[l] = a[3 * r + 1];
    A.row[r].z[l] = a[3 * r + 2];
  }
}

/// Symmetric matrix: xx, yy, zz, yz, xz, xy.
struct Symmetric {
  Pack xx, yy, zz, yz, xz, xy;
};
PALPATE_INLINE Matrix full(const Symmetric& S) {
  return {{{S.xx, S.xy, S.xz}, {S.xy, S.yy, S.yz}, {S.xz, S.yz, S.zz}}};
}
/// A^T A and A A^T
PALPATE_INLINE Symmetric gram_of_columns(const Matrix& A) {
  const Vector &a = A.row[0], &b = A.row[1], &c = A.row[2];
  return {a.x * a.x + b.x * b.x + c.x * c.x, a.y * a.y + b.y * b.y + c.y * c.y,
          a.z * a.z + b.z * b.z + c.z * c.z, a.y * a.z + b.y * b.z + c.y * c.z,
          a.x * a.z + b.x * b.z + c.x * c.z, a.x * a.y + b.x * b.y + c.x * c.y};
}
PALPATE_INLINE Symmetric gram_of_rows(const Matrix& A) {
  return {dot(A.row[0], A.row[0]), dot(A.row[1], A.row[1]), dot(A.row[2], A.row[2]),
          dot(A.row[1], A.row[2]), dot(A.row[0], A.row[2]), dot(A.row[0], A.row[1])};
}

/// block += a b^T
PALPATE_INLINE void add_outer(Matrix& block, const Vector& a, const Vector& b) {
  block.row[0] = block.row[0] + a.x * b;
  block.row[1] = block.row[1] + a.y * b;
  block.row[2] = block.row[2] + a.z * b;
}
PALPATE_INLINE void add_diagonal(Matrix& block, Pack s) {
  block.row[0].x += s;
  block.row[1].y += s;
  block.row[2].z += s;
}

/// Unsigned and as wide as an address, so that products need no widening.
PALPATE_INLINE std::size_t index_of(std::uint16_t number) { return number; }

// Transposition between lanes (one number of several elements) and rows (several numbers of one element).

#if PALPATE_WIDTH == 2

/// Gathers a nodal field with four doubles per node.
PALPATE_INLINE Vector gather(const double* field, const std::uint16_t* node) {
  const double *p = field + 4 * index_of(node[0]), *q = field + 4 * index_of(node[1]);
  return {Pack{p[0], q[0]}, Pack{p[1], q[1]}, Pack{p[2], q[2]}};
}
PALPATE_INLINE void scatter_add(double* field, const std::uint16_t* node, const Vector& f) {
  for (int l = 0; l < 2; ++l) {
    double* p = field + 4 * index_of(node[l]);
    p[0] += f.x[l];
    p[1] += f.y[l];
    p[2] += f.z[l];
  }
}
/// Adds entries 0 to 7 of a block to its edge's row of eight.
PALPATE_INLINE void scatter_rows(double* rows, const std::uint16_t* edge, const Pack* k) {
  PackInMemory *first = reinterpret_cast<PackInMemory*>(rows + 8 * index_of(edge[0])),
               *second = reinterpret_cast<PackInMemory*>(rows + 8 * index_of(edge[1]));
  for (int c = 0; c < 4; ++c) first[c] += __builtin_shufflevector(k[2 * c], k[2 * c + 1], 0, 2);
  for (int c = 0; c < 4; ++c) second[c] += __builtin_shufflevector(k[2 * c], k[2 * c + 1], 1, 3);
}

#elif PALPATE_WIDTH == 4

PALPATE_INLINE Vector gather(const double* field, const std::uint16_t* node) {
  const Pack a = load(field + 4 * index_of(node[0])), b = load(field + 4 * index_of(node[1])),
             c = load(field + 4 * index_of(node[2])), d = load(field + 4 * index_of(node[3]));
  const Pack ab = __builtin_shufflevector(a, b, 0, 4, 2, 6), cd = __builtin_shufflevector(c, d, 0, 4, 2, 6);
  const Pack ab_y = __builtin_shufflevector(a, b, 1, 5, 3, 7),
             cd_y = __builtin_shufflevector(c, d, 1, 5, 3, 7);
  return {__builtin_shufflevector(ab, cd, 0, 1, 4, 5), __builtin_shufflevector(ab_y, cd_y, 0, 1, 4, 5),
          __builtin_shufflevector(ab, cd, 2, 3, 6, 7)};
}
/// Row l of the result: entry l of the four packs.
PALPATE_INLINE void transpose(const Pack* k, Pack* row) {
  const Pack a = __builtin_shufflevector(k[0], k[1], 0, 4, 2, 6),
             b = __builtin_shufflevector(k[2], k[3], 0, 4, 2, 6);
  const Pack c = __builtin_shufflevector(k[0], k[1], 1, 5, 3, 7),
             d = __builtin_shufflevector(k[2], k[3], 1, 5, 3, 7);
  row[0] = __builtin_shufflevector(a, b, 0, 1, 4, 5);
  row[1] = __builtin_shufflevector(c, d, 0, 1, 4, 5);
  row[2] = __builtin_shufflevector(a, b, 2, 3, 6, 7);
  row[3] = __builtin_shufflevector(c, d, 2, 3, 6, 7);
}
PALPATE_INLINE void scatter_add(double* field, const std::uint16_t* node, const Vector& f) {
  const Pack k[4] = {f.x, f.y, f.z, Pack{}};
  Pack row[4];
  transpose(k, row);
  for (int l = 0; l < 4; ++l) *reinterpret_cast<PackInMemory*>(field + 4 * index_of(node[l])) += row[l];
}
PALPATE_INLINE void scatter_rows(double* rows, const std::uint16_t* edge, const Pack* k) {
  Pack low[4], high[4];
  transpose(k, low);
  transpose(k + 4, high);
  for (int l = 0; l < 4; ++l) {
    PackInMemory* row = reinterpret_cast<PackInMemory*>(rows + 8 * index_of(edge[l]));
    row[0] += low[l];
    row[1] += high[l];
  }
}

#else

typedef double Quad __attribute__((vector_size(32)));
typedef double QuadInMemory __attribute__((vector_size(32), may_alias));
PALPATE_INLINE Pack pair(const double* low, const double* high) {
  return __builtin_shufflevector(*reinterpret_cast<const QuadInMemory*>(low),
                                 *reinterpret_cast<const QuadInMemory*>(high), 0, 1, 2, 3, 4, 5, 6, 7);
}
PALPATE_INLINE Pack even(Pack a, Pack b) { return __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14); }
PALPATE_INLINE Pack odd(Pack a, Pack b) { return __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15); }
PALPATE_INLINE Pack low_pairs(Pack a, Pack b) {
  return __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13);
}
PALPATE_INLINE Pack high_pairs(Pack a, Pack b) {
  return __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
}

PALPATE_INLINE Vector gather(const double* field, const std::uint16_t* node) {
  const Pack a = pair(field + 4 * index_of(node[0]), field + 4 * index_of(node[4])),
             b = pair(field + 4 * index_of(node[1]), field + 4 * index_of(node[5]));
  const Pack c = pair(field + 4 * index_of(node[2]), field + 4 * index_of(node[6])),
             d = pair(field + 4 * index_of(node[3]), field + 4 * index_of(node[7]));
  const Pack ab = even(a, b), cd = even(c, d);
  return {low_pairs(ab, cd), low_pairs(odd(a, b), odd(c, d)), high_pairs(ab, cd)};
}
PALPATE_INLINE void add_quad(double* p, Quad q) { *reinterpret_cast<QuadInMemory*>(p) += q; }
PALPATE_INLINE void scatter_add(double* field, const std::uint16_t* node, const Vector& f) {
  const Pack zero{}, xy = even(f.x, f.y), z = even(f.z, zero), xy_odd = odd(f.x, f.y), z_odd = odd(f.z, zero);
  const Pack rows[4] = {low_pairs(xy, z), low_pairs(xy_odd, z_odd), high_pairs(xy, z),
                        high_pairs(xy_odd, z_odd)};
  for (int l = 0; l < 4; ++l) {
    add_quad(field + 4 * index_of(node[l]), __builtin_shufflevector(rows[l], rows[l], 0, 1, 2, 3));
    add_quad(field + 4 * index_of(node[l + 4]), __builtin_shufflevector(rows[l], rows[l], 4, 5, 6, 7));
  }
}
PALPATE_INLINE void scatter_rows(double* rows, const std::uint16_t* edge, const Pack* k) {
  const Pack a0 = even(k[0], k[1]), a1 = odd(k[0], k[1]), b0 = even(k[2], k[3]), b1 = odd(k[2], k[3]);
  const Pack c0 = even(k[4], k[5]), c1 = odd(k[4], k[5]), d0 = even(k[6], k[7]), d1 = odd(k[6], k[7]);
  // [entries 0-3 of lane l | of lane l + 4], and entries 4-7
  const Pack low[4] = {low_pairs(a0, b0), low_pairs(a1, b1), high_pairs(a0, b0), high_pairs(a1, b1)};
  const Pack high[4] = {low_pairs(c0, d0), low_pairs(c1, d1), high_pairs(c0, d0), high_pairs(c1, d1)};
  for (int l = 0; l < 4; ++l) {
    *reinterpret_cast<PackInMemory*>(rows + 8 * index_of(edge[l])) +=
        __builtin_shufflevector(low[l], high[l], 0, 1, 2, 3, 8, 9, 10, 11);
    *reinterpret_cast<PackInMemory*>(rows + 8 * index_of(edge[l + 4])) +=
        __builtin_shufflevector(low[l], high[l], 4, 5, 6, 7, 12, 13, 14, 15);
  }
}

#endif
