#define PALPATE_KERNELS baseline
#define PALPATE_NAME "baseline"
#define PALPATE_WIDTH 2
#include "fem/lane_kernels.inl"
