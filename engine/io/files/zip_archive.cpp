#include "engine/io/files/zip_archive.h"

#include <algorithm>
#include <cstdio>
#include <vector>

#include <archive.h>
#include <archive_entry.h>
#include <fmt/format.h>

namespace fettle::engine {

struct ZipReader::Source {
  const InputFile& file;
  std::uint64_t at = 0;
  std::vector<char> buffer = std::vector<char>(std::size_t{1} << 16);

  static la_ssize_t read(archive*, void* self, const void** out) {
    auto* source = static_cast<Source*>(self);
    const auto got = source->file.read(source->at, source->buffer.data(), source->buffer.size());
    if (!got) return ARCHIVE_FATAL;
    source->at += *got;
    *out = source->buffer.data();
    return static_cast<la_ssize_t>(*got);
  }
  static la_int64_t seek(archive*, void* self, la_int64_t offset, int whence) {
    auto* source = static_cast<Source*>(self);
    const auto base = static_cast<la_int64_t>(whence == SEEK_SET   ? 0
                                              : whence == SEEK_CUR ? source->at
                                                                   : source->file.size());
    if (offset < -base) return ARCHIVE_FATAL;
    source->at = static_cast<std::uint64_t>(base + offset);
    return base + offset;
  }
};

void ZipReader::FreeSource::operator()(Source* source) const noexcept {
  delete source;
}
void ZipReader::Free::operator()(archive* a) const noexcept {
  archive_read_free(a);
}
void ZipWriter::Free::operator()(archive* a) const noexcept {
  archive_write_free(a);
}

ZipReader::ZipReader(const InputFile& file)
    : file_(file), source_(new Source{file}), archive_(archive_read_new()) {
  archive* a = archive_.get();
  // Only by the directory at the end: an archive without one is cut short, and guessed entries would give
  // wrong heights.
  archive_read_support_format_zip_seekable(a);
  archive_read_set_read_callback(a, &Source::read);
  archive_read_set_seek_callback(a, &Source::seek);
  archive_read_set_callback_data(a, source_.get());
  if (archive_read_open1(a) != ARCHIVE_OK)
    status_ =
        inputError("this is not a complete zip archive", file.path(), "the file is cut short or damaged");
}

tl::unexpected<Error> ZipReader::refuse(const std::string& otherwise) const {
  const char* text = archive_error_string(archive_.get());
  return inputError(fmt::format("the archive cannot be read: {}", text != nullptr ? text : otherwise),
                    file_.path(), "the file is damaged, encrypted or cut short");
}

bool ZipReader::next() {
  if (!status_) return false;
  archive_entry* entry = nullptr;
  const int got = archive_read_next_header(archive_.get(), &entry);
  if (got == ARCHIVE_EOF) return false;
  if (got < ARCHIVE_WARN) {  // a warning is about names or times
    status_ = refuse("its directory is damaged");
    return false;
  }
  const char* name = archive_entry_pathname(entry);
  if (name == nullptr) name = archive_entry_pathname_utf8(entry);
  name_ = name != nullptr ? name : "";
  std::replace(name_.begin(), name_.end(), '\\', '/');  // as written by some programs on Windows
  return true;
}

bool ZipReader::find(std::string_view name) {
  while (next())
    if (name_ == name) return true;
  return false;
}

Result<std::size_t> ZipReader::read(char* out, std::size_t bytes) {
  std::size_t got = 0;
  while (got < bytes) {
    const la_ssize_t now = archive_read_data(archive_.get(), out + got, bytes - got);
    if (now < 0) return refuse("an entry is damaged");
    if (now == 0) break;
    got += static_cast<std::size_t>(now);
  }
  return got;
}

ZipWriter::ZipWriter(AtomicFile& file) : sink_(new Sink{&file, {}}), archive_(archive_write_new()) {
  archive* a = archive_.get();
  archive_write_set_format_zip(a);
  archive_write_zip_set_compression_deflate(a);
  archive_write_set_bytes_in_last_block(a, 1);
  archive_write_open(
      a, sink_.get(), nullptr,
      [](archive*, void* self, const void* bytes, std::size_t count) -> la_ssize_t {
        auto* sink = static_cast<Sink*>(self);
        // After an error nothing more is written, but the library does not get that error: an archive that
        // has failed does not free the compressor of its current entry (libarchive 3.6.2).
        if (sink->status) sink->status = sink->file->write({static_cast<const char*>(bytes), count});
        return static_cast<la_ssize_t>(count);
      },
      nullptr);
}

Status ZipWriter::refuse() const {
  if (!sink_->status) return sink_->status;
  const char* text = archive_error_string(archive_.get());
  return failure(fmt::format("the archive cannot be written: {}", text != nullptr ? text : "unknown"),
                 sink_->file->finalPath());
}

Status ZipWriter::begin(const std::string& name, std::uint64_t bytes) {
  archive_entry* entry = archive_entry_new();
  archive_entry_set_pathname(entry, name.c_str());
  archive_entry_set_filetype(entry, AE_IFREG);
  archive_entry_set_perm(entry, 0644);
  archive_entry_set_size(entry, static_cast<la_int64_t>(bytes));
  const int done = archive_write_header(archive_.get(), entry);
  archive_entry_free(entry);
  return done == ARCHIVE_OK ? sink_->status : refuse();
}

Status ZipWriter::write(const char* bytes, std::size_t count) {
  const la_ssize_t done = archive_write_data(archive_.get(), bytes, count);
  return done == static_cast<la_ssize_t>(count) ? sink_->status : refuse();
}

Status ZipWriter::finish() {
  return archive_write_close(archive_.get()) == ARCHIVE_OK ? sink_->status : refuse();
}

}  // namespace fettle::engine
