#include <random>
#include <vector>

#include "helpers.h"

// Reading any file ends in a mesh or in palpate::Error: any other exception fails the test, and sanitizers
// detect the rest.
namespace {

struct Sample {
  std::string name;
  std::string text;
};

const std::vector<Sample> kSamples = {
    {"a.msh",
     "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 "
     "1\n$EndNodes\n$Elements\n3\n"
     "1 2 2 0 1 1 2 3\n2 4 2 0 1 1 2 3 4\n3 4 2 0 1 2 3 4 5\n$EndElements\n"},
    {"b.msh",
     "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n2 5 1 5\n2 1 1 2\n1\n2\n0 0 0 0 0\n1 0 0 1 0\n3 1 0 "
     "3\n3\n4\n5\n0 1 0\n0 0 1\n1 1 1\n$EndNodes\n"
     "$Elements\n2 3 1 3\n2 1 2 1\n1 1 2 3\n3 1 4 2\n2 1 2 3 4\n3 2 3 4 5\n$EndElements\n"},
    {"c.node", "5 3 1 1\n0 0 0 0 1 1\n1 1 0 0 1 1\n2 0 1 0 1 1\n3 0 0 1 1 1\n4 1 1 1 1 0 # last\n"},
    {"c.ele", "2 4 1\n0 0 1 2 3 9\n1 1 2 3 4 9\n"},
    {"d.obj",
     "o cube\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\nvn 0 0 1\nf 4 3 2 1\nf "
     "5//1 6//1 7//1 8//1\nf 1 2 6 5\n"
     "f -7 -6 -2 -3\nf 3 4 8 7\nf 4 1 5\nf 4 5 8\n"},
};

/// Flips bytes, repeats or removes a piece, or truncates the text.
std::string mutated(std::string text, std::mt19937& random) {
  const auto position = [&] { return text.empty() ? 0 : random() % text.size(); };
  static const std::string kTelling = "0123456789-+.e \n$/#\0\xFF";
  for (unsigned i = 0, edits = 1 + random() % 4; i < edits && !text.empty(); ++i) {
    const std::size_t at = position();
    switch (random() % 6) {
      case 0: text[at] = static_cast<char>(text[at] ^ (1 << random() % 8)); break;
      case 1: text[at] = static_cast<char>(random() % 256); break;
      case 2: text[at] = kTelling[random() % kTelling.size()]; break;
      case 3: text.insert(at, text.substr(position(), random() % 20)); break;
      case 4: text.erase(at, random() % 20); break;
      case 5: text.resize(at); break;
    }
  }
  return text;
}

}  // namespace

TEST(Fuzz, EveryMutatedFileIsReadOrRefused) {
  std::mt19937 random(2007);
  const TempFolder folder;
  for (const auto& sample : kSamples) folder.write(sample.name, sample.text);
  int accepted = 0, refused = 0;
  for (int round = 0; round < 1000; ++round)
    for (const auto& sample : kSamples) {
      folder.write(sample.name, mutated(sample.text, random));
      if (error_of([&] { read_any(folder.path(), sample.name); }) == "nothing was refused")
        ++accepted;
      else
        ++refused;
      folder.write(sample.name, sample.text);
    }
  EXPECT_EQ(accepted + refused, 5000);
  EXPECT_GT(accepted, 100) << "mutations are too rough to reach the checks";
  EXPECT_GT(refused, 2000) << "mutations are too gentle";
}
