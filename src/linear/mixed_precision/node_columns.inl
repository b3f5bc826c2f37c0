// Part of node_kernels.inl: operations on several vectors over the nodes at once (response_columns.h), in
// register tiles: each number that is loaded is used as often as the tile is wide. The zeros after the last
// node are part of every vector, and stay zero.

constexpr int kTile = 4, kTileAcross = PALPATE_LANES == 16 ? 4 : 2;
/// Numbers that are summed in single precision before the sum is added to a sum in double.
constexpr std::int64_t kSummedInSingle = 1024;

PALPATE_INLINE Wide take_wide(const float* p) { return *reinterpret_cast<const WideAnywhere*>(p); }
PALPATE_INLINE void put_wide(float* p, const Wide& v) { *reinterpret_cast<WideAnywhere*>(p) = v; }

void inner_products(int rows, int columns, const float* const* V, const float* const* W, std::int64_t size,
                    double* out) {
  for (int j0 = 0; j0 < columns; j0 += kTileAcross)
    for (int i0 = 0; i0 < rows; i0 += kTile) {
      const float *v[kTile], *w[kTileAcross];
      for (int i = 0; i < kTile; ++i) v[i] = V[i0 + i < rows ? i0 + i : rows - 1];
      for (int j = 0; j < kTileAcross; ++j) w[j] = W[j0 + j < columns ? j0 + j : columns - 1];
      double total[kTile][kTileAcross] = {};
      for (std::int64_t first = 0; first < size; first += kSummedInSingle) {
        const std::int64_t last = first + kSummedInSingle < size ? first + kSummedInSingle : size;
        Wide sums[kTile][kTileAcross] = {};
        for (std::int64_t k = first; k < last; k += kLanes) {
          Wide across[kTileAcross];
          for (int j = 0; j < kTileAcross; ++j) across[j] = take_wide(w[j] + k);
          for (int i = 0; i < kTile; ++i) {
            const Wide one = take_wide(v[i] + k);
            for (int j = 0; j < kTileAcross; ++j) sums[i][j] += one * across[j];
          }
        }
        for (int i = 0; i < kTile; ++i)
          for (int j = 0; j < kTileAcross; ++j)
            for (int l = 0; l < kLanes; ++l) total[i][j] += static_cast<double>(sums[i][j][l]);
      }
      for (int j = 0; j < kTileAcross && j0 + j < columns; ++j)
        for (int i = 0; i < kTile && i0 + i < rows; ++i) out[i0 + i + rows * (j0 + j)] = total[i][j];
    }
}

// A tile's columns beyond the last repeat the last one: they load and store the same values.
void add_columns(int from, int to, const float* const* V, const float* Y, float* const* W,
                 std::int64_t size) {
  for (int j0 = 0; j0 < to; j0 += kTileAcross)
    for (int i0 = 0; i0 < from; i0 += kTile) {
      const float* v[kTile];
      float *w[kTileAcross], y[kTile][kTileAcross];
      for (int i = 0; i < kTile; ++i) v[i] = V[i0 + i < from ? i0 + i : from - 1];
      for (int j = 0; j < kTileAcross; ++j) {
        const int column = j0 + j < to ? j0 + j : to - 1;
        w[j] = W[column];
        for (int i = 0; i < kTile; ++i) y[i][j] = i0 + i < from ? Y[i0 + i + from * column] : 0.0f;
      }
      for (std::int64_t k = 0; k < size; k += kLanes) {
        Wide sums[kTileAcross];
        for (int j = 0; j < kTileAcross; ++j) sums[j] = take_wide(w[j] + k);
        for (int i = 0; i < kTile; ++i) {
          const Wide one = take_wide(v[i] + k);
          for (int j = 0; j < kTileAcross; ++j) sums[j] += y[i][j] * one;
        }
        for (int j = 0; j < kTileAcross; ++j) put_wide(w[j] + k, sums[j]);
      }
    }
}
