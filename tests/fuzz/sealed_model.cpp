#include "tests/fuzz/sealed_model.h"

#include "core/error.h"
#include "pipeline/store/hash.h"
#include "pipeline/store/hostile_json.h"
#include "pipeline/store/seal.h"
#include "tests/temp_folder.h"

namespace npdr::pipeline {

H5Model model_of(const Schema& schema, const std::function<void(h5::File&)>& write) {
  const TempFolder folder;
  const Identity identity{key_document(schema), {{"target", "0"}}, {{"name", "s"}}, 1};
  ArtefactWriter writer(folder / "a.h5", schema, identity);
  write(writer.file());
  writer.finish();
  return H5Model::of(folder / "a.h5");
}

void write_sealed(H5Model model, const std::filesystem::path& path) {
  try {
    const std::string document = model.values.at("@key_document").texts.at(0);
    model.values.at("@key").texts = {content_key(parse_json(document, "key"))};
  } catch (const std::out_of_range&) {  // one of them is gone
  } catch (const InputError&) {         // or no JSON
  }
  model.write(path);
  seal_file(path, path);
}

}  // namespace npdr::pipeline
