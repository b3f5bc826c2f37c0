#define PALPATE_KERNELS avx512
#define PALPATE_NAME "avx512"
#define PALPATE_WIDTH 8
#include "fem/lane_kernels.inl"
