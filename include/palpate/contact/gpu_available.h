#pragma once

namespace palpate::contact {

/// Whether this build has contact in image space (PALPATE_WITH_GL); without it make_gpu_source() throws
/// Error.
bool gpu_available();

}  // namespace palpate::contact
