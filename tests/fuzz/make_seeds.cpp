// Writes the seeds that a text editor cannot create: `fuzz_make_seeds CORPUS` (ninja fuzz_make_seeds).
#include <cstdio>

#include "fuzz/seeds.h"
#include "palpate/device/udp.h"
#include "store/atomic_file.h"

using namespace palpate;

int main(int argc, char** argv) {
  if (argc != 2) return std::fputs("fuzz_make_seeds CORPUS\n", stderr), 2;
  const std::string corpus = argv[1];
  fuzz::write_mesh_seed(corpus + "/mesh_file/two-tets.h5");
  fuzz::write_model_seed(corpus + "/model_file/everything.h5");
  fuzz::write_bare_model_seed(corpus + "/model_file/skin-alone.h5");
  fuzz::write_run_seed(corpus + "/run_file/two-steps.vtkhdf");
  fuzz::write_checkpoint_seed(corpus + "/checkpoint_file/one-of-each.h5");
  const auto keep = [&](const char* name, const auto& bytes) {
    store::write_atomically(corpus + "/udp_packet/" + name, std::string(bytes.begin(), bytes.end()));
  };
  device::PosePacket pose;
  pose.sequence = 7, pose.time = 0.5, pose.switches = 1;
  pose.pose = {Quat::Identity(), Vec3(1, 2, 3)};
  keep("pose", device::encode(pose));
  keep("wrench", device::encode(device::WrenchPacket{7, 0.5, {Vec3(1, 2, 3), Vec3(4, 5, 6)}}));
}
