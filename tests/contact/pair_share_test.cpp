// Every pair of proxies is in one part of a region, however often it is divided.
#include "contact/pair_share.h"

#include <gtest/gtest.h>

#include <random>

using namespace palpate;
using contact::PairShare;
using contact::RegionPart;

namespace {

using Pairs = std::vector<std::pair<int, int>>;

std::vector<RegionPart> parts_of(const std::vector<Pairs>& pairs) {
  std::vector<RegionPart> out;
  for (const Pairs& p : pairs) {
    out.emplace_back();
    out.back().pairs = p;
  }
  return out;
}

std::vector<PairShare> divide(const PairShare& whole, const std::vector<RegionPart>& parts) {
  std::vector<PairShare> out(parts.size());
  for (std::size_t i = 0; i < parts.size(); ++i) out[i].take_part(whole, parts, i);
  return out;
}

}  // namespace

TEST(PairShare, BothFlanksOfAToothAreApart) {
  const std::vector<RegionPart> parts = parts_of({{{4, 0}, {5, 0}}, {{4, 1}}});
  const auto shares = divide({}, parts);
  EXPECT_TRUE(shares[0].has(4, 0) && shares[0].has(5, 0) && !shares[0].has(4, 1));
  EXPECT_TRUE(shares[1].has(4, 1) && !shares[1].has(4, 0));
  // what does not press stays in the first part that has the proxy, else in the first
  EXPECT_TRUE(shares[0].has(4, 7) && !shares[1].has(4, 7));
  EXPECT_TRUE(shares[0].has(9, 1));
  EXPECT_TRUE(PairShare::has_proxy(parts, 0, 9) && !PairShare::has_proxy(parts, 1, 9));
  EXPECT_TRUE(PairShare::has_proxy(parts, 0, 4) && PairShare::has_proxy(parts, 1, 4));
  EXPECT_FALSE(PairShare::has_proxy(parts, 1, 5));
}

// of 6 x 6 pairs, some press; those in a part are divided again, one of them in its own place
TEST(PairShare, EachPairIsInOnePart) {
  std::mt19937 random(5);
  int shared = 0;
  for (int repeat = 0; repeat < 300; ++repeat) {
    const auto some_parts = [&](const PairShare& of) {
      std::vector<Pairs> pairs(1 + random() % 3);
      for (int a = 0; a < 6; ++a)
        for (int b = 0; b < 6; ++b)
          if (of.has(a, b) && random() % 2 == 0) pairs[random() % pairs.size()].push_back({a, b});
      std::erase_if(pairs, [](const Pairs& p) { return p.empty(); });
      if (pairs.empty()) pairs.push_back({});
      return parts_of(pairs);
    };
    const auto first = some_parts({});
    std::vector<PairShare> shares = divide({}, first);
    std::vector<std::vector<bool>> sees(shares.size(), std::vector<bool>(6));  // the proxies of a
    for (std::size_t i = 0; i < shares.size(); ++i)
      for (int a = 0; a < 6; ++a) sees[i][static_cast<std::size_t>(a)] = PairShare::has_proxy(first, i, a);
    const std::size_t which = random() % shares.size();
    auto pressing = some_parts(shares[which]);
    for (RegionPart& part : pressing)  // what it does not see cannot press
      std::erase_if(part.pairs, [&](const auto& p) { return !sees[which][static_cast<std::size_t>(p.first)]; });
    const PairShare whole = shares[which];
    const std::vector<bool> seen = sees[which];
    for (std::size_t i = 1; i < pressing.size(); ++i) {
      shares.emplace_back().take_part(whole, pressing, i);
      auto& sees_now = sees.emplace_back(6);
      for (int a = 0; a < 6; ++a)
        sees_now[static_cast<std::size_t>(a)] =
            seen[static_cast<std::size_t>(a)] && PairShare::has_proxy(pressing, i, a);
    }
    shares[which].take_part(shares[which], pressing, 0);
    for (int a = 0; a < 6; ++a)
      sees[which][static_cast<std::size_t>(a)] =
          seen[static_cast<std::size_t>(a)] && PairShare::has_proxy(pressing, 0, a);
    for (int a = 0; a < 6; ++a)
      for (int b = 0; b < 6; ++b) {
        int parts = 0, drawn = 0;
        for (std::size_t i = 0; i < shares.size(); ++i) {
          drawn += sees[i][static_cast<std::size_t>(a)];
          parts += sees[i][static_cast<std::size_t>(a)] && shares[i].has(a, b);
        }
        EXPECT_EQ(parts, 1) << repeat << ": " << a << ", " << b;
        shared += drawn > 1;
      }
  }
  EXPECT_GT(shared, 1000);
}
