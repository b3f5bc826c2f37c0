#pragma once

namespace palpate::cli {

/// Returns the OpenBLAS kernels that are fastest on this CPU, by their name for OPENBLAS_CORETYPE; null to
/// leave the choice to OpenBLAS.
const char* openblas_core_type();

/// Restarts this program with the settings that OpenBLAS and libgomp read only while they are loaded. Call it
/// once, before anything else, in commands that factorise. Settings of the user take precedence. Returns if
/// there is nothing to change, or if exec fails (the program is then slower, not wrong).
void restart_tuned(char** argv);

/// Ends the process if it was started to test whether its libraries load within a limit on the address space.
/// Must be called first.
void end_where_loading_is_tried();

}  // namespace palpate::cli
