#include "pipeline/store/h5_detail.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
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

constexpr std::size_t kMostText = 100'000'000;  // bytes

Handle text_type(std::size_t size, H5T_cset_t characters) {
  Handle type(H5Tcopy(H5T_C_S1));
  H5Tset_size(type.id(), size);
  H5Tset_cset(type.id(), characters);
  return type;
}

std::string bits(hid_t stored) { return fmt::format("{}-bit", 8 * H5Tget_size(stored)); }

bool is_unsigned(hid_t stored) { return H5Tget_sign(stored) == H5T_SGN_NONE; }

// One text in a field of fixed width: it ends at a NUL, or where the padding begins.
std::string trimmed(const char* field, std::size_t width, H5T_str_t padding) {
  std::string text(field, strnlen(field, width));
  if (padding == H5T_STR_SPACEPAD) text.resize(text.find_last_not_of(' ') + 1);
  return text;
}

std::vector<std::string> read_fixed_texts(hid_t stored, Index count, const std::string& where,
                                          const RawRead& read) {
  const std::size_t width = H5Tget_size(stored);
  // A small file may claim very many zeros.
  if (static_cast<std::size_t>(count) > kMostText / std::max<std::size_t>(width, 1)) {
    throw InputError(fmt::format("{} has {} texts of {} bytes, must be at most {} in all", where,
                                 count, width, kMostText));
  }
  std::vector<char> buffer(static_cast<std::size_t>(count) * width);
  if (read(stored, buffer.data()) < 0) fail_reading(where, "be read");
  std::vector<std::string> texts;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    texts.push_back(trimmed(buffer.data() + i * width, width, H5Tget_strpad(stored)));
  }
  return texts;
}

// A copy of that of f32, f64, u8 or i64, in this order, or the type of texts.
Handle type_among(const std::array<hid_t, 4>& numbers, ElementType type) {
  if (type == ElementType::text) return text_type(H5T_VARIABLE, H5T_CSET_UTF8);
  return Handle(H5Tcopy(numbers.at(static_cast<std::size_t>(type))));
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

Handle select_rows(hid_t space, const Shape& shape, Index begin, Index count) {
  if (shape.empty()) return Handle(H5Screate(H5S_SCALAR));
  std::vector<hsize_t> start(shape.size(), 0);
  std::vector<hsize_t> extent(shape.begin(), shape.end());
  start[0] = static_cast<hsize_t>(begin);
  extent[0] = static_cast<hsize_t>(count);
  H5Sselect_hyperslab(space, H5S_SELECT_SET, start.data(), nullptr, extent.data(), nullptr);
  return Handle(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr));
}

Index size_of(const Shape& shape) {
  Index size = 1;
  for (const Index extent : shape) size *= extent;
  return size;
}

Handle memory_type(ElementType type) {
  return type_among({H5T_NATIVE_FLOAT, H5T_NATIVE_DOUBLE, H5T_NATIVE_UINT8, H5T_NATIVE_INT64},
                    type);
}

Handle file_type(ElementType type) {
  return type_among({H5T_IEEE_F32LE, H5T_IEEE_F64LE, H5T_STD_U8LE, H5T_STD_I64LE}, type);
}

std::string describe(hid_t stored) {
  switch (H5Tget_class(stored)) {
    case H5T_FLOAT:
      return bits(stored) + " floats";
    case H5T_INTEGER:
      return bits(stored) + (is_unsigned(stored) ? " unsigned integers" : " integers");
    case H5T_STRING:
      return "texts";
    case H5T_COMPOUND:
      return "compound records";
    case H5T_ENUM:
      return "enumerated values";
    default:
      return "values of another type";
  }
}

std::string describe(ElementType type) { return describe(file_type(type).id()); }

bool fits(hid_t stored, ElementType type) {
  const H5T_class_t kind = H5Tget_class(stored);
  if (type == ElementType::text) return kind == H5T_STRING;
  const std::size_t size = H5Tget_size(stored);
  if (type == ElementType::f32 || type == ElementType::f64) {
    return kind == H5T_FLOAT && size <= (type == ElementType::f32 ? 4 : 8);
  }
  if (kind != H5T_INTEGER) return false;
  if (type == ElementType::u8) return size == 1 && is_unsigned(stored);
  return size < 8 || (size == 8 && !is_unsigned(stored));
}

bool can_be_read_as(hid_t stored, ElementType type) {
  return fits(stored, type) || (type == ElementType::f64 && H5Tget_class(stored) == H5T_INTEGER);
}

ElementType our_type(hid_t stored, const std::string& where) {
  for (const ElementType type :
       {ElementType::text, ElementType::f32, ElementType::f64, ElementType::u8, ElementType::i64}) {
    if (fits(stored, type)) return type;
  }
  throw InputError(where + " holds " + describe(stored) + ", must hold numbers or texts");
}

std::vector<std::string> read_texts(hid_t stored, hid_t space, Index count,
                                    const std::string& where, const RawRead& read) {
  if (H5Tis_variable_str(stored) <= 0) return read_fixed_texts(stored, count, where, read);
  const Handle memory = text_type(H5T_VARIABLE, H5Tget_cset(stored));
  std::vector<char*> pointers(static_cast<std::size_t>(count), nullptr);
  if (read(memory.id(), pointers.data()) < 0) fail_reading(where, "be read");
  std::vector<std::string> texts;
  for (const char* pointer : pointers) texts.emplace_back(pointer == nullptr ? "" : pointer);
  H5Dvlen_reclaim(memory.id(), space, H5P_DEFAULT, pointers.data());
  return texts;
}

void write_texts(const std::vector<std::string>& texts, const std::string& where,
                 const RawWrite& write) {
  std::vector<const char*> pointers;
  for (const std::string& text : texts) {
    if (text.find('\0') != std::string::npos) {
      throw Error(where + ": can't hold a text with a NUL character");
    }
    pointers.push_back(text.c_str());
  }
  const Handle memory = memory_type(ElementType::text);
  written(write(memory.id(), pointers.data()), where, "be written");
}

}  // namespace npdr::pipeline::h5
