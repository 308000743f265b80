// Tests dyn_model_image and dyn_model_from_buffer: a model in memory that is only read gives the same bits as the one on the
// heap, wherever it lies, and nothing that was damaged is taken.
#include <sys/mman.h>

#include <algorithm>
#include <cstdlib>

#include "capi/support.hpp"

namespace dyn_test {
namespace {

struct Robot {
  const char* name;
  dynBase base;
  Model load() const { return robot(name, base); }
} const robots[] = {
    {"panda", DYN_BASE_FIXED}, {"go2", DYN_BASE_FLOATING}, {"gripper", DYN_BASE_FIXED}, {"humanoid", DYN_BASE_FLOATING}};

std::vector<char> image_of(const dynModel* m, uint32_t flags = 0) {
  size_t size = 0;
  EXPECT_EQ(DYN_OK, dyn_model_image(m, flags, nullptr, 0, &size));
  std::vector<char> bytes(size);
  EXPECT_EQ(DYN_OK, dyn_model_image(m, flags, bytes.data(), size, &size));
  return bytes;
}

// Pages that can't be written, with the bytes `at` into the first one.
class Flash {
 public:
  explicit Flash(const std::vector<char>& bytes, size_t at = 0)
      : size_(bytes.size() + at),
        memory_(mmap(nullptr, size_, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0)),
        at_(at) {
    std::memcpy(static_cast<char*>(memory_) + at, bytes.data(), bytes.size());
    mprotect(memory_, size_, PROT_READ);
  }
  ~Flash() { munmap(memory_, size_); }
  Flash(const Flash&) = delete;
  const void* data() const { return static_cast<char*>(memory_) + at_; }

 private:
  size_t size_;
  void* memory_;
  size_t at_;
};

Numbers ramp(int n, double scale) {
  Numbers x(static_cast<size_t>(n));
  for (int k = 0; k < n; ++k) x[size_t(k)] = scale * (k % 7 - 3);
  return x;
}

// tau, ddq and M, and the state after some steps
Numbers results(const dynModel* m) {
  const Data d(m);
  const size_t nq = size_t(dyn_model_nq(m)), nv = size_t(dyn_model_nv(m));
  Numbers q(nq), out(3 * nv + nv * nv + nq);
  EXPECT_EQ(DYN_OK, dyn_configuration_neutral(m, q.data()));
  const Numbers v = ramp(int(nv), 0.1), a = ramp(int(nv), -0.3);
  EXPECT_EQ(DYN_OK, dyn_rnea(m, d, q.data(), v.data(), a.data(), nullptr, out.data()));
  EXPECT_EQ(DYN_OK, dyn_aba(m, d, q.data(), v.data(), a.data(), nullptr, out.data() + nv));
  EXPECT_EQ(DYN_OK, dyn_crba(m, d, q.data(), out.data() + 3 * nv));
  for (int k = 0; k < 20; ++k) EXPECT_EQ(DYN_OK, dyn_step(m, d)) << dyn_last_error();
  dynArray x{};
  x.struct_size = sizeof x;
  EXPECT_EQ(DYN_OK, dyn_data_array(m, d, dyn_field_id("v"), &x));
  std::copy(x.data, x.data + nv, out.begin() + std::ptrdiff_t(2 * nv));
  EXPECT_EQ(DYN_OK, dyn_data_array(m, d, dyn_field_id("q"), &x));
  std::copy(x.data, x.data + nq, out.begin() + std::ptrdiff_t(3 * nv + nv * nv));
  return out;
}

TEST(Image, ModelsInPlaceGiveTheSameBits) {
  for (const Robot& r : robots) {
    SCOPED_TRACE(r.name);
    const Model heap = r.load();
    const Numbers expected = results(heap);
    for (const size_t at : {size_t(0), size_t(64), size_t(4096)}) {
      const Flash flash(image_of(heap), at);
      const dynModel* m = nullptr;
      ASSERT_EQ(DYN_OK, dyn_model_from_buffer(flash.data(), image_of(heap).size(), &m)) << dyn_last_error();
      EXPECT_EQ(expected, results(m));
      EXPECT_STREQ(dyn_model_joint_name(heap, 1), dyn_model_joint_name(m, 1));
      EXPECT_EQ(dyn_model_frame_id(heap, dyn_model_frame_name(heap, 3)), dyn_model_frame_id(m, dyn_model_frame_name(m, 3)));
      EXPECT_EQ(dyn_model_report_count(heap), dyn_model_report_count(m));
      dyn_model_free(const_cast<dynModel*>(m));  // not ours to free
      EXPECT_EQ(dyn_model_nv(heap), dyn_model_nv(m));
      // an image of it is the same image
      EXPECT_EQ(image_of(heap), image_of(m));
    }
  }
}

TEST(Image, DataOfOneIsNotThatOfAnother) {
  const Model panda = robots[0].load(), go2 = robots[1].load();
  const std::vector<char> image = image_of(panda), other = image_of(go2);
  const Flash flash(image), again(image), different(other);
  const dynModel *m = nullptr, *same = nullptr, *o = nullptr;
  ASSERT_EQ(DYN_OK, dyn_model_from_buffer(flash.data(), image.size(), &m));
  ASSERT_EQ(DYN_OK, dyn_model_from_buffer(again.data(), image.size(), &same));
  ASSERT_EQ(DYN_OK, dyn_model_from_buffer(different.data(), other.size(), &o));
  const Data d(m);
  EXPECT_EQ(DYN_OK, dyn_step(same, d));  // equal content: one model
  EXPECT_EQ(DYN_ERROR_MODEL, dyn_step(o, d));
  EXPECT_EQ(DYN_ERROR_MODEL, dyn_step(panda, d));
}

TEST(Image, WithoutNamesTheNumbersStay) {
  for (const Robot& r : robots) {
    SCOPED_TRACE(r.name);
    const Model heap = r.load();
    const std::vector<char> whole = image_of(heap), image = image_of(heap, DYN_IMAGE_NAMELESS);
    EXPECT_LT(image.size(), whole.size());
    EXPECT_LT(image_of(heap, DYN_IMAGE_NAMELESS | DYN_IMAGE_NARROW).size(), image.size());
    const Flash flash(image);
    const dynModel* m = nullptr;
    ASSERT_EQ(DYN_OK, dyn_model_from_buffer(flash.data(), image.size(), &m)) << dyn_last_error();
    EXPECT_EQ(results(heap), results(m));
    EXPECT_STREQ("", dyn_model_joint_name(m, 1));
    EXPECT_STREQ("", dyn_model_name(m));
    EXPECT_EQ(-1, dyn_model_joint_id(m, dyn_model_joint_name(heap, 1)));
    EXPECT_EQ(0, dyn_model_report_count(m));
  }
}

TEST(Image, ArgumentsAreChecked) {
  const Model heap = robots[0].load();
  const std::vector<char> image = image_of(heap);
  const Flash flash(image), odd(image, 8), narrow(image_of(heap, DYN_IMAGE_NARROW));
  const dynModel* m = nullptr;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_model_from_buffer(nullptr, image.size(), &m));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_model_from_buffer(flash.data(), image.size(), nullptr));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_model_from_buffer(odd.data(), image.size(), &m));
  EXPECT_EQ(DYN_ERROR_UNSUPPORTED, dyn_model_from_buffer(narrow.data(), image_of(heap, DYN_IMAGE_NARROW).size(), &m));
  EXPECT_EQ(nullptr, m);
  size_t size = 7;
  char byte;
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_model_image(heap, 0, nullptr, 0, nullptr));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_model_image(heap, 0, nullptr, 5, &size));
  EXPECT_EQ(DYN_ERROR_ARGUMENT, dyn_model_image(heap, 4, nullptr, 0, &size));
  EXPECT_EQ(7u, size);
  EXPECT_EQ(DYN_ERROR_SIZE, dyn_model_image(heap, 0, &byte, 1, &size));
}

// Of the same layout as a .dynb file: one is read as the other, but for what has no names.
TEST(Image, AFileIsAnImage) {
  const Model heap = robots[2].load();
  size_t size = 0;
  ASSERT_EQ(DYN_OK, dyn_model_save_memory(heap, DYN_FORMAT_DYNB, nullptr, nullptr, 0, &size));
  std::vector<char> file(size);
  ASSERT_EQ(DYN_OK, dyn_model_save_memory(heap, DYN_FORMAT_DYNB, nullptr, file.data(), size, &size));
  EXPECT_EQ(image_of(heap), file);
}

// Every byte changed, and every shorter length: no damage is taken for a model.
TEST(Image, DamagedImagesAreRefused) {
  const Model heap = robots[2].load();
  const std::vector<char> image = image_of(heap, DYN_IMAGE_NAMELESS);
  const std::unique_ptr<void, void (*)(void*)> memory(std::aligned_alloc(64, (image.size() + 63) / 64 * 64), std::free);
  char* bytes = static_cast<char*>(memory.get());
  std::memcpy(bytes, image.data(), image.size());
  const dynModel* m = nullptr;
  for (size_t k = 0; k < image.size(); ++k) {
    bytes[k] = char(bytes[k] ^ (1 << (k % 8)));
    ASSERT_NE(DYN_OK, dyn_model_from_buffer(bytes, image.size(), &m)) << k;
    ASSERT_NE(DYN_OK, dyn_model_from_buffer(bytes, k, &m)) << k;
    bytes[k] = image[k];
    ASSERT_NE(DYN_OK, dyn_model_from_buffer(bytes, k, &m)) << k;
  }
  EXPECT_EQ(nullptr, m);
  EXPECT_EQ(DYN_OK, dyn_model_from_buffer(bytes, image.size(), &m));
}

}  // namespace
}  // namespace dyn_test
