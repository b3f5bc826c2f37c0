#pragma once

namespace palpate::linear {

/// Makes the BLAS take the memory that it works in, once a process, before a run needs it.  OpenBLAS maps
/// some 128 MiB of addresses at the first product of its calling thread and keeps them; where the system
/// denies them, it asks again for ever.  So under a limit of addresses a child process tries first.
/// @throws Error with what is left where the BLAS does not come back
void reserve_blas_memory();

/// Refuses a factor that does not fit, once its size is known exactly and before it is taken.
/// @param unknowns  of the matrix  @param bytes  of the factor
void refuse_factor_beyond_memory(double unknowns, double bytes);

/// Reports that an allocation of the solver failed.
/// @throws Error with what is left
[[noreturn]] void fail_without_memory(const char* call, double unknowns);

}  // namespace palpate::linear
