#include "live/frame_message.h"

#include <gtest/gtest.h>

#include <bit>
#include <thread>

#include "live/byte_writer.h"

namespace palpate::live {
namespace {

template <class Number>
Number read(const Bytes& bytes, std::size_t at) {
  Number out;
  std::memcpy(&out, bytes.data() + at, sizeof out);
  return out;
}

TEST(ByteWriter, WritesLittleEndianBehindKindAndLength) {
  Bytes bytes = {9, 9, 9};
  ByteWriter out(bytes, 1);
  out.add(std::uint32_t{0x01020304});
  out.add(1.0F);
  out.close();
  EXPECT_EQ(bytes, (Bytes{1, 0, 0, 0, 16, 0, 0, 0, 4, 3, 2, 1, 0, 0, 0x80, 0x3f}));
}

TEST(FrameMessage, HasTheLayoutOfTheProtocol) {
  ForceStrip strip(1);
  for (int i = 1; i <= 31; ++i) {
    Wrench w;
    w.force = {1.0 * i, 0.0, 0.0};
    w.moment = {0.0, 2.0, 0.0};
    strip.add(0, 1e-3 * i, w);
  }
  StripHistory history;
  history.read(strip);
  EXPECT_EQ(history.end(), 6U);
  Frame frame{0.03, {1.5F, -2.0F, std::bit_cast<float>(5U)}};
  Bytes bytes;
  std::uint64_t next = 2;
  write_frame(frame, history, 1, next, bytes);
  EXPECT_EQ(next, 6U);
  ASSERT_EQ(bytes.size(), 8U + 8U + 4U + 3U * 4U + 4U * 7U * 4U);
  EXPECT_EQ(read<std::uint32_t>(bytes, 0), 2U);
  EXPECT_EQ(read<std::uint32_t>(bytes, 4), bytes.size());
  EXPECT_EQ(read<double>(bytes, 8), 0.03);
  EXPECT_EQ(read<std::uint32_t>(bytes, 16), 4U);
  EXPECT_EQ(read<float>(bytes, 20), 1.5F);
  EXPECT_EQ(read<std::uint32_t>(bytes, 28), 5U) << "flags";
  EXPECT_NEAR(read<float>(bytes, 32), 0.011F - 0.03F, 1e-7F) << "first row: the least force of 11 to 20 ms";
  EXPECT_EQ(read<float>(bytes, 36), 11.0F);
  EXPECT_EQ(read<float>(bytes, 52), 2.0F) << "torque about y";
  EXPECT_NEAR(read<float>(bytes, 32 + 3 * 28), 0.0F, 1e-7F) << "last row: at the frame's time";
  EXPECT_EQ(read<float>(bytes, 36 + 3 * 28), 30.0F);
  write_frame(frame, history, 1, next, bytes);
  EXPECT_EQ(read<std::uint32_t>(bytes, 16), 0U) << "no row is sent twice";
}

TEST(FrameMessage, AViewerThatWasAwayGetsTheLastTenSeconds) {
  StripHistory history;
  ForceStrip strip(1);
  for (int i = 1; i <= 30'000; ++i) {
    strip.add(0, 1e-3 * i, {});
    if (i % 100 == 0) history.read(strip);
  }
  Bytes bytes;
  std::uint64_t next = 0;
  write_frame({30.0, {}}, history, 1, next, bytes);
  EXPECT_EQ(read<std::uint32_t>(bytes, 16), ForceStrip::kCapacity);
  EXPECT_EQ(next, history.end());
}

TEST(FrameBuffer, TheReaderGetsOnlyTheNewestCompleteFrame) {
  FrameBuffer buffer(2);
  EXPECT_FALSE(buffer.take());
  for (int i = 1; i <= 3; ++i) {
    buffer.back().time_s = i;
    buffer.publish();
  }
  EXPECT_TRUE(buffer.take());
  EXPECT_EQ(buffer.front().time_s, 3.0);
  EXPECT_FALSE(buffer.take());
}

TEST(FrameBuffer, FramesAreNeverTornBetweenTwoThreads) {
  constexpr int kFrames = 200'000;
  FrameBuffer buffer(64);
  std::thread writer([&] {
    for (int i = 1; i <= kFrames; ++i) {
      Frame& frame = buffer.back();
      frame.time_s = i;
      std::fill(frame.values.begin(), frame.values.end(), static_cast<float>(i));
      buffer.publish();
    }
  });
  double last = 0.0;
  int taken = 0, torn = 0;
  while (last < kFrames) {
    if (!buffer.take()) continue;
    const Frame& frame = buffer.front();
    for (const float value : frame.values) torn += value != static_cast<float>(frame.time_s);
    EXPECT_GT(frame.time_s, last);
    last = frame.time_s;
    ++taken;
  }
  writer.join();
  EXPECT_EQ(torn, 0);
  EXPECT_GT(taken, 0);
}

}  // namespace
}  // namespace palpate::live
