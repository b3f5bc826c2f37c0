#include "render/animation.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

#include "palpate/core/error.h"

namespace palpate::render {
namespace {

constexpr std::string_view kSignature("\x89PNG\r\n\x1a\n", 8);
constexpr long kCountAt = 8 + 25;  ///< Position of acTL: behind the signature and IHDR.
constexpr std::size_t kChannels = 4;

void put_16(std::string& out, std::uint32_t value) {
  out += {static_cast<char>(value >> 8), static_cast<char>(value)};
}
void put_32(std::string& out, std::uint32_t value) { put_16(out, value >> 16), put_16(out, value); }

struct Rectangle {
  int x = 0, y = 0, width = 1, height = 1;
};

bool same_pixel(const Picture& a, const Picture& b, int x, int y) {
  return std::memcmp(a.pixel(x, y), b.pixel(x, y), kChannels) == 0;
}

/// Returns the bounding rectangle of all pixels that differ; one pixel where none does.
Rectangle difference(const Picture& a, const Picture& b) {
  int left = a.width, right = -1, top = a.height, bottom = -1;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x)
      if (!same_pixel(a, b, x, y)) {
        left = std::min(left, x), right = std::max(right, x);
        top = std::min(top, y), bottom = y;
      }
  return right < 0 ? Rectangle{} : Rectangle{left, top, right - left + 1, bottom - top + 1};
}

std::uint8_t paeth(int left, int up, int corner) {
  const int p = left + up - corner, a = std::abs(p - left), b = std::abs(p - up), c = std::abs(p - corner);
  return static_cast<std::uint8_t>(a <= b && a <= c ? left : b <= c ? up : corner);
}

/// Filters one row by one of PNG's five filters.  @param above  preceding row, or zeros
void filter(const std::uint8_t* row, const std::uint8_t* above, std::size_t bytes, int kind,
            std::uint8_t* out) {
  for (std::size_t i = 0; i < bytes; ++i) {
    const int left = i < kChannels ? 0 : row[i - kChannels],
              corner = i < kChannels ? 0 : above[i - kChannels];
    const int guess = kind == 0   ? 0
                      : kind == 1 ? left
                      : kind == 2 ? above[i]
                      : kind == 3 ? (left + above[i]) / 2
                                  : paeth(left, above[i], corner);
    out[i] = static_cast<std::uint8_t>(row[i] - guess);
  }
}

/// Filters each row by the filter with the least sum of magnitudes, and puts the filter's number before it.
std::string filtered(const std::vector<std::uint8_t>& pixels, std::size_t row_bytes, std::size_t rows) {
  std::string out;
  out.reserve(rows * (row_bytes + 1));
  const std::vector<std::uint8_t> zeros(row_bytes, 0);
  std::vector<std::uint8_t> trial(row_bytes), best(row_bytes);
  for (std::size_t y = 0; y < rows; ++y) {
    const std::uint8_t* row = &pixels[y * row_bytes];
    const std::uint8_t* above = y == 0 ? zeros.data() : row - row_bytes;
    long least = -1;
    char kind_of_best = 0;
    for (int kind = 0; kind < 5 && least != 0; ++kind) {
      filter(row, above, row_bytes, kind, trial.data());
      long sum = 0;
      for (const std::uint8_t v : trial) sum += std::min<int>(v, 256 - v);
      if (least >= 0 && sum >= least) continue;
      least = sum;
      kind_of_best = static_cast<char>(kind);
      std::swap(trial, best);
    }
    out += kind_of_best;
    out.append(reinterpret_cast<const char*>(best.data()), row_bytes);
  }
  return out;
}

std::string deflated(const std::string& bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string out(size, '\0');
  const int status =
      compress2(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                static_cast<uLong>(bytes.size()), Z_DEFAULT_COMPRESSION);
  PALPATE_CHECK(status == Z_OK, "zlib: {}", status);
  out.resize(size);
  return out;
}

/// Returns a rectangle of the picture as PNG's compressed rows; pixels equal to those of `shown` are
/// transparent.
std::string encoded(const Picture& picture, const std::optional<Picture>& shown, const Rectangle& r) {
  const std::size_t row_bytes = kChannels * static_cast<std::size_t>(r.width);
  std::vector<std::uint8_t> pixels(row_bytes * static_cast<std::size_t>(r.height), 0);
  std::uint8_t* out = pixels.data();
  for (int y = r.y; y < r.y + r.height; ++y)
    for (int x = r.x; x < r.x + r.width; ++x, out += kChannels)
      if (!shown || !same_pixel(picture, *shown, x, y)) std::memcpy(out, picture.pixel(x, y), kChannels);
  return deflated(filtered(pixels, row_bytes, static_cast<std::size_t>(r.height)));
}

}  // namespace

Fraction fraction_of(double seconds) {
  PALPATE_CHECK(seconds > 0.0, "{} s", seconds);
  for (const int denominator : {10000, 1000, 100, 10})
    if (seconds * denominator <= 65535.0)
      return {std::max(1, static_cast<int>(std::lround(seconds * denominator))), denominator};
  return {static_cast<int>(std::lround(std::min(seconds, 65535.0))), 1};
}

struct AnimationWriter::Impl {
  std::filesystem::path path;
  Fraction delay;
  std::FILE* file = nullptr;
  std::optional<Picture> shown;            ///< Previous picture.
  std::uint32_t pictures = 0, number = 0;  ///< number: sequence number of the next fcTL or fdAT.

  ~Impl() {
    if (file) std::fclose(file);
  }

  [[noreturn]] void refuse() const {
    fail("{}: the animation cannot be written: {}", path.string(), std::strerror(errno));
  }

  void write(std::string_view bytes) {
    if (std::fwrite(bytes.data(), 1, bytes.size(), file) != bytes.size()) refuse();
  }

  void chunk(const char* type, const std::string& data) {
    std::string out;
    put_32(out, static_cast<std::uint32_t>(data.size()));
    out += type + data;
    const auto* checked = reinterpret_cast<const Bytef*>(out.data()) + 4;
    put_32(out, static_cast<std::uint32_t>(crc32(0, checked, static_cast<uInt>(out.size() - 4))));
    write(out);
  }

  void write_head(const Picture& first) {
    write(kSignature);
    std::string header;
    put_32(header, static_cast<std::uint32_t>(first.width));
    put_32(header, static_cast<std::uint32_t>(first.height));
    // 8 bits per channel; RGBA; default compression and filter methods; no interlacing.
    header += {8, 6, 0, 0, 0};
    chunk("IHDR", header);
    write_count();
  }

  void write_count() {
    std::string count;
    put_32(count, pictures);
    put_32(count, 0);  // Number of plays: endless.
    chunk("acTL", count);
  }

  void write_control(const Rectangle& r) {
    std::string control;
    put_32(control, number++);
    for (const int side : {r.width, r.height, r.x, r.y}) put_32(control, static_cast<std::uint32_t>(side));
    put_16(control, static_cast<std::uint32_t>(delay.numerator));
    put_16(control, static_cast<std::uint32_t>(delay.denominator));
    // Dispose: none; blend: over the previous frame, or source for the first.
    control += {0, static_cast<char>(shown ? 1 : 0)};
    chunk("fcTL", control);
  }
};

AnimationWriter::AnimationWriter(const std::filesystem::path& path, double frame_s)
    : impl_(std::make_unique<Impl>()) {
  impl_->path = path;
  impl_->delay = fraction_of(frame_s);
  impl_->file = std::fopen(path.c_str(), "wb");
  if (!impl_->file) impl_->refuse();
}

AnimationWriter::~AnimationWriter() = default;

void AnimationWriter::add(const Picture& picture) {
  Impl& a = *impl_;
  if (!a.shown) a.write_head(picture);
  PALPATE_CHECK(!a.shown || (picture.width == a.shown->width && picture.height == a.shown->height),
                "{} x {} pixels behind {} x {}", picture.width, picture.height, a.shown->width,
                a.shown->height);
  const Rectangle changed =
      a.shown ? difference(*a.shown, picture) : Rectangle{0, 0, picture.width, picture.height};
  a.write_control(changed);
  const std::string data = encoded(picture, a.shown, changed);
  if (a.shown) {
    std::string numbered;
    put_32(numbered, a.number++);
    a.chunk("fdAT", numbered + data);
  } else {
    a.chunk("IDAT", data);
  }
  a.shown = picture;
  ++a.pictures;
}

void AnimationWriter::close() {
  Impl& a = *impl_;
  PALPATE_CHECK(a.pictures > 0, "an animation of no picture");
  a.chunk("IEND", "");
  if (std::fseek(a.file, kCountAt, SEEK_SET) != 0) a.refuse();
  a.write_count();
  const int closed = std::fclose(a.file);
  a.file = nullptr;
  if (closed != 0) a.refuse();
}

}  // namespace palpate::render
