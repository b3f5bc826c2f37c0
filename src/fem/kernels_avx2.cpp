#define PALPATE_KERNELS avx2
#define PALPATE_NAME "avx2"
#define PALPATE_WIDTH 4
#include "fem/lane_kernels.inl"
