/// How artefacts are read, written and listed by their descriptions: the definitions of schemas.h,
/// for files that instantiate them.
#pragma once

#include <utility>

#include "core/error.h"
#include "pipeline/artefacts/layout.h"
#include "pipeline/artefacts/schemas.h"

namespace npdr::pipeline {

template <class T>
void Artefact<T>::write(h5::File& file, T value) const {
  describe(Layout::writer(file), value);
}

template <class T>
void Artefact<T>::write(const std::filesystem::path& path, const Identity& identity,
                        T value) const {
  ArtefactWriter writer(path, *this, identity);
  if constexpr (requires { value.cost; }) writer.add_cost(value.cost);
  write(writer.file(), std::move(value));
  writer.finish();
}

template <class T>
T Artefact<T>::read(const ArtefactFile& artefact) const {
  const h5::File file = open_artefact(artefact, *this);
  T value;
  describe(Layout::reader(file), value);
  if constexpr (requires { value.cost; }) value.cost = provenance_of(file).cost;
  return value;
}

template <class T>
std::optional<T> Artefact<T>::read_if_there(const ArtefactFile& artefact) const try {
  return read(artefact);
} catch (const Error&) {
  if (std::filesystem::exists(artefact.path)) throw;
  return std::nullopt;
}

template <class T>
void Artefact<T>::list(Layout f) {
  T value;
  describe(std::move(f), value);
}

}  // namespace npdr::pipeline
