#pragma once

namespace palpate::cli {

/// The OpenBLAS kernels that this CPU runs best, by the name that OPENBLAS_CORETYPE understands; null where
/// OpenBLAS's own choice stands.
const char* openblas_core_type();

/// For commands that factorise, once, before anything else: starts this program anew with the settings that
/// OpenBLAS and libgomp read only while they are loaded.  Settings that the person made stand.  Returns when
/// there is nothing to change (or exec fails: then slower, not wrong).
void restart_tuned(char** argv);

/// Ends the process where it was started to see whether its libraries load within a limit on addresses.  To
/// be called first.
void end_where_loading_is_tried();

}  // namespace palpate::cli
