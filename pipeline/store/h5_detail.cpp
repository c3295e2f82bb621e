#include "pipeline/store/h5_detail.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <limits>
#include <system_error>

#include "core/file_error.h"

namespace npdr::pipeline::h5 {
namespace {

// HDF5's entries say "..., errno = 28, error message = ..." where a system call failed.
int error_number(const std::string& text) {
  constexpr std::string_view key = "errno = ";
  const std::size_t begin = text.find(key);
  int number = 0;
  if (begin != std::string::npos) {
    std::from_chars(text.data() + begin + key.size(), text.data() + text.size(), number);
  }
  return number;
}

// Such an entry without file positions, times and addresses: what failed, and the system's reason.
std::string readable(const std::string& text) {
  const int number = error_number(text);
  if (number == 0) return text;
  std::size_t end = text.find(", errno = ");
  for (const char* detail : {": time = ", ": name = "}) end = std::min(end, text.find(detail));
  return fmt::format("{}: {}", text.substr(0, end), std::generic_category().message(number));
}

// The file in which closing something failed, "": none did. HDF5 then keeps an identifier of freed
// memory, and may crash in any later call.
std::array<char, 1024> unsound_file{};

// Of the file that an identifier is about; "?" where it's about none.
std::array<char, 1024> file_name(hid_t id) {
  std::array<char, 1024> name{"?"};
  if (H5Iget_type(id) == H5I_FILE || H5Iget_type(id) == H5I_GROUP ||
      H5Iget_type(id) == H5I_DATASET || H5Iget_type(id) == H5I_ATTR) {
    H5Fget_name(id, name.data(), name.size());
  }
  return name;
}

herr_t take_description(unsigned n, const H5E_error2_t* entry, void* result) {
  if (n == 0 && entry->desc != nullptr) *static_cast<std::string*>(result) = entry->desc;
  return 0;
}

}  // namespace

void prepare() {
  require_sound();
  static const bool is_first = [] {
    H5dont_atexit();
    return H5Lunregister(H5L_TYPE_EXTERNAL) >= 0;
  }();
  static_cast<void>(is_first);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

void require_sound() {
  if (unsound_file.front() == '\0') return;
  throw Error(
      std::string(unsound_file.data()) +
      ": HDF5 couldn't close this file, as after an error of the disk or network, and can't "
      "go on in this process; run again");
}

std::string reason() {
  std::string text;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, take_description, &text);
  return text.empty() ? "HDF5 gives no reason" : text;
}

void fail_reading(const std::string& where, const std::string& action) {
  const std::string why = reason();
  const std::string text = fmt::format("{}: can't {}: {}", where, action, readable(why));
  const int number = error_number(why);
  constexpr std::array of_the_file = {0, ENOENT, ENOTDIR, ENAMETOOLONG, ELOOP};
  if (std::ranges::find(of_the_file, number) != of_the_file.end()) throw InputError(text);
  throw Error(text + read_advice(number));
}

bool is_true(int answer, const std::string& where) {
  if (answer < 0 && error_number(reason()) != 0) fail_reading(where, "be looked into");
  return answer > 0;
}

void fail_writing(const std::string& where, const std::string& action) {
  const std::string why = reason();
  throw Error(fmt::format("{}: can't {}: {}{}", where, action, readable(why),
                          file_advice(error_number(why))));
}

Handle opened(hid_t id, const std::string& where, const std::string& action) {
  if (id < 0) fail_reading(where, action);
  return Handle(id);
}

Handle created(hid_t id, const std::string& where, const std::string& action) {
  if (id < 0) fail_writing(where, action);
  return Handle(id);
}

void written(herr_t status, const std::string& where, const std::string& action) {
  if (status < 0) fail_writing(where, action);
}

Handle properties_of(const Object& dataset) {
  return opened(H5Dget_create_plist(dataset.id()), dataset.where(), "say how it is stored");
}

Handle::~Handle() {
  if (id_ < 0 || H5Iis_valid(id_) <= 0) return;
  const auto name = file_name(id_);  // afterwards nobody knows
  if (H5Idec_ref(id_) < 0) unsound_file = name;
}

std::string to_string(const Shape& shape) {
  std::string text;
  for (const Index extent : shape) {
    if (!text.empty()) text += ", ";
    text += extent < 0 ? "any" : std::to_string(extent);
  }
  return "(" + text + ")";
}

Shape shape_of(hid_t space, const std::string& where) {
  const int rank = H5Sget_simple_extent_ndims(space);
  if (rank < 0 || H5Sget_simple_extent_type(space) == H5S_NULL) {
    throw InputError(where + ": holds no array");
  }
  std::vector<hsize_t> extents(static_cast<std::size_t>(rank));
  H5Sget_simple_extent_dims(space, extents.data(), nullptr);
  Index total = 1;
  for (const hsize_t extent : extents) {
    // Room for the size in bytes of any element type.
    constexpr auto limit = std::numeric_limits<Index>::max() / 1024;
    if (extent > static_cast<hsize_t>(limit) ||
        __builtin_mul_overflow(total, static_cast<Index>(extent), &total) || total > limit) {
      throw InputError(where + ": claims an impossible number of values");
    }
  }
  return {extents.begin(), extents.end()};
}

Handle make_space(const Shape& shape) {
  if (shape.empty()) return Handle(H5Screate(H5S_SCALAR));
  const std::vector<hsize_t> extents(shape.begin(), shape.end());
  return Handle(H5Screate_simple(static_cast<int>(extents.size()), extents.data(), nullptr));
}

Index size_of(const Shape& shape) {
  Index size = 1;
  for (const Index extent : shape) size *= extent;
  return size;
}

}  // namespace npdr::pipeline::h5
