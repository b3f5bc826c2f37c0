#include "palpate/contact/gpu_available.h"
#include "palpate/contact/sources.h"
#include "palpate/core/error.h"

namespace palpate::contact {

namespace {

[[noreturn]] void absent() {
  fail(
      "contact method = \"gpu\" is not built in; configure with -DPALPATE_WITH_GL=ON (packages libepoxy-dev, "
      "libegl-dev)");
}

}  // namespace

bool gpu_available() { return false; }

std::unique_ptr<SampleSource> make_gpu_source(NodeSurface, TriMesh, int, std::shared_ptr<MovingFrame>,
                                              const GpuOptions&) {
  absent();
}
std::unique_ptr<SampleSource> make_gpu_source(NodeSurface, std::shared_ptr<proxy::ProxySet>, TriMesh,
                                              std::shared_ptr<proxy::ProxySet>, int,
                                              std::shared_ptr<MovingFrame>, const GpuOptions&) {
  absent();
}
std::unique_ptr<SampleSource> make_gpu_source(NodeSurface, NodeSurface, const GpuOptions&) { absent(); }
std::unique_ptr<SampleSource> make_gpu_source(NodeSurface, std::shared_ptr<proxy::ProxySet>, NodeSurface,
                                              std::shared_ptr<proxy::ProxySet>, const GpuOptions&) {
  absent();
}
std::unique_ptr<SampleSource> make_gpu_source(NodeSurface, std::shared_ptr<proxy::ProxySet>, const Points&,
                                              const GpuOptions&) {
  absent();
}

}  // namespace palpate::contact
