#include "palpate/contact/sources.h"
#include "palpate/core/error.h"

namespace palpate::contact {

std::unique_ptr<SampleSource> make_gpu_source(NodeSurface, TriMesh, int, std::shared_ptr<MovingFrame>, const GpuOptions&) {
  fail("contact method = \"gpu\" is not built in; configure with -DPALPATE_WITH_GL=ON (packages libepoxy-dev, libegl-dev, libccd-dev)");
}

}  // namespace palpate::contact
