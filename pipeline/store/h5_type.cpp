#include <fmt/format.h>

#include <array>
#include <cstring>

#include "pipeline/store/h5_detail.h"

namespace npdr::pipeline::h5 {
namespace {

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
