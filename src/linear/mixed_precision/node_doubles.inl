// Part of node_kernels.inl: kernels that read a matrix in double, or packed rows for a product in double.

PALPATE_INLINE double sum3(const FourDouble& v) { return (v[0] + v[1]) + v[2]; }

bool convert(const DoubleBlocks& A, double scale, float* out, int first, int last) {
  Eight probe{};  // 0 x is NaN where x is infinite or NaN
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
      if (A.source[s] == A.last_slot) {  // loading a block's last row reads one number past the block
        for (int k = 0; k < 9; ++k) copy[k] = block[k];
        copy[9] = 0.0;
        block = copy;
      }
      const FourDouble x =
          *reinterpret_cast<const FourDoubleAnywhere*>(v + 4 * static_cast<std::int64_t>(A.column[s]));
      for (int r = 0; r < 3; ++r) total[r] += *reinterpret_cast<const FourDoubleAnywhere*>(block + 3 * r) * x;
    }
    double* y = Av + 4 * static_cast<std::int64_t>(i);
    for (int r = 0; r < 3; ++r) y[r] = sum3(total[r]);
    y[3] = 0.0;
  }
}

// Products of a zero-row-sum matrix in double, with half as many rows per vector.

constexpr int kHalf = PALPATE_LANES / 2;
typedef double Half __attribute__((vector_size(8 * kHalf)));
typedef float HalfSingle __attribute__((vector_size(4 * kHalf), may_alias));

struct Half3 {
  Half x, y, z;
};
#if PALPATE_LANES == 16
PALPATE_INLINE Half beside(const double* front, const double* back) {
  return __builtin_shufflevector(FourDouble(*reinterpret_cast<const FourDoubleAnywhere*>(front)),
                                 FourDouble(*reinterpret_cast<const FourDoubleAnywhere*>(back)), 0, 1, 2, 3,
                                 4, 5, 6, 7);
}
PALPATE_INLINE void gather(const double* field, const int* at, Half3& v) {
  const Half a = beside(field + at[0], field + at[4]), b = beside(field + at[1], field + at[5]),
             c = beside(field + at[2], field + at[6]), d = beside(field + at[3], field + at[7]);
  const Half ab = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14),
             cd = __builtin_shufflevector(c, d, 0, 8, 2, 10, 4, 12, 6, 14);
  const Half ab_y = __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15),
             cd_y = __builtin_shufflevector(c, d, 1, 9, 3, 11, 5, 13, 7, 15);
  v.x = __builtin_shufflevector(ab, cd, 0, 1, 8, 9, 4, 5, 12, 13);
  v.y = __builtin_shufflevector(ab_y, cd_y, 0, 1, 8, 9, 4, 5, 12, 13);
  v.z = __builtin_shufflevector(ab, cd, 2, 3, 10, 11, 6, 7, 14, 15);
}
#elif PALPATE_LANES == 8
PALPATE_INLINE void gather(const double* field, const int* at, Half3& v) {
  Half n[4];
  for (int l = 0; l < 4; ++l) n[l] = *reinterpret_cast<const FourDoubleAnywhere*>(field + at[l]);
  const Half ab = __builtin_shufflevector(n[0], n[1], 0, 4, 2, 6),
             cd = __builtin_shufflevector(n[2], n[3], 0, 4, 2, 6);
  const Half ab_y = __builtin_shufflevector(n[0], n[1], 1, 5, 3, 7),
             cd_y = __builtin_shufflevector(n[2], n[3], 1, 5, 3, 7);
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

PALPATE_INLINE void subtract_four(double* p, const FourDouble& v) {
  *reinterpret_cast<FourDoubleAnywhere*>(p) = *reinterpret_cast<const FourDoubleAnywhere*>(p) - v;
}
#if PALPATE_LANES == 16
PALPATE_INLINE void scatter_subtract(double* field, const int* at, const Half3& v) {
  const Half none{};
  const Half xy = __builtin_shufflevector(v.x, v.y, 0, 8, 2, 10, 4, 12, 6, 14),
             z = __builtin_shufflevector(v.z, none, 0, 8, 2, 10, 4, 12, 6, 14);
  const Half xy_odd = __builtin_shufflevector(v.x, v.y, 1, 9, 3, 11, 5, 13, 7, 15),
             z_odd = __builtin_shufflevector(v.z, none, 1, 9, 3, 11, 5, 13, 7, 15);
  const Half rows[4] = {__builtin_shufflevector(xy, z, 0, 1, 8, 9, 4, 5, 12, 13),
                        __builtin_shufflevector(xy_odd, z_odd, 0, 1, 8, 9, 4, 5, 12, 13),
                        __builtin_shufflevector(xy, z, 2, 3, 10, 11, 6, 7, 14, 15),
                        __builtin_shufflevector(xy_odd, z_odd, 2, 3, 10, 11, 6, 7, 14, 15)};
  for (int l = 0; l < 4; ++l) {
    subtract_four(field + at[l], __builtin_shufflevector(rows[l], rows[l], 0, 1, 2, 3));
    subtract_four(field + at[l + 4], __builtin_shufflevector(rows[l], rows[l], 4, 5, 6, 7));
  }
}
#elif PALPATE_LANES == 8
PALPATE_INLINE void scatter_subtract(double* field, const int* at, const Half3& v) {
  const Half none{};
  const Half xy = __builtin_shufflevector(v.x, v.y, 0, 4, 2, 6),
             z = __builtin_shufflevector(v.z, none, 0, 4, 2, 6);
  const Half xy_odd = __builtin_shufflevector(v.x, v.y, 1, 5, 3, 7),
             z_odd = __builtin_shufflevector(v.z, none, 1, 5, 3, 7);
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

void multiply_zero_row_sum(const PackedRows& A, const double* mass, double unit, const double* v,
                           double* Av) {
  const std::int64_t begin = 4 * static_cast<std::int64_t>(A.first_node),
                     end = 4 * static_cast<std::int64_t>(A.last_node);
  for (std::int64_t k = begin; k < end; ++k) Av[k] = 0.0;
  for (int g = A.first_group; g < A.last_group; ++g)
    for (int part = 0; part < 2 * kParts; ++part) {
      const int* row = A.row + kLanesOfGroup * g + kHalf * part;
      Half3 own, sum{}, other;
      gather(v, row, own);
      for (std::int64_t s = A.step_start[g]; s < A.step_start[g + 1]; ++s) {
        const float* values = A.values + kNumbersOfStep * s + kHalf * part;
        const int* column = A.column + kLanesOfGroup * s + kHalf * part;
        if (part == 0)
          for (int line = 0; line < kNumbersOfStep; line += 16)
            __builtin_prefetch(values + kFloatsAhead + line);
        Half block[9];
        for (int k = 0; k < 9; ++k)
          block[k] =
              __builtin_convertvector(*reinterpret_cast<const HalfSingle*>(values + kLanesOfGroup * k), Half);
        gather(v, column, other);
        const Half x = other.x - own.x, y = other.y - own.y, z = other.z - own.z;
        sum = {sum.x - block[0] * x - block[3] * y - block[6] * z,
               sum.y - block[1] * x - block[4] * y - block[7] * z,
               sum.z - block[2] * x - block[5] * y - block[8] * z};
        if (s < A.single_start[g])
          scatter_subtract(
              Av, column,
              {block[0] * x + block[1] * y + block[2] * z, block[3] * x + block[4] * y + block[5] * z,
               block[6] * x + block[7] * y + block[8] * z});
      }
      scatter_subtract(Av, row, sum);
    }
  for (std::int64_t k = begin; k < end; ++k) Av[k] = unit * (Av[k] + mass[k] * v[k]);
}

// Inverses by cofactors, eight nodes in lanes. Positive definite exactly when the leading minors are positive
// (Sylvester).
bool invert_diagonal(const double* values, const int* slot, double scale, float* inverse, int first,
                     int last) {
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
      const double a = yy[l] * zz[l] - yz[l] * yz[l], b = xz[l] * yz[l] - xy[l] * zz[l],
                   c = xy[l] * yz[l] - xz[l] * yy[l];
      const double minor = xx[l] * yy[l] - xy[l] * xy[l], det = xx[l] * a + xy[l] * b + xz[l] * c,
                   by = 1.0 / (scale * det);
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
