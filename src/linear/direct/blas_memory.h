#pragma once

namespace palpate::linear {

/// Makes the BLAS allocate its work memory, once per process, before a run needs it. OpenBLAS maps some 128
/// MiB of address space at the first product of each calling thread and keeps it; where the system denies the
/// memory, it retries forever. Under an address-space limit the product is therefore tried in a child process
/// first.
/// @throws Error with the memory left if the BLAS does not return
void reserve_blas_memory();

/// Rejects a factor that does not fit into memory, once its size is known exactly and before it is allocated.
/// @param unknowns  Rows of the matrix.
/// @param bytes  Size of the factor [bytes].
/// @throws Error with the memory left
void refuse_factor_beyond_memory(double unknowns, double bytes);

/// Reports that an allocation of the solver library failed.
/// @param call  Library function that failed.
/// @param unknowns  Rows of the matrix.
/// @throws Error with the memory left
[[noreturn]] void fail_without_memory(const char* call, double unknowns);

}  // namespace palpate::linear
