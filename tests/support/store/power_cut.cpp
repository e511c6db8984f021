#include "support/store/power_cut.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <set>

namespace beltpick::test {
namespace {

namespace fs = std::filesystem;

struct Inode {
  bool folder = false;
  std::string bytes;
  std::size_t flushed = 0;
};

// One change of a folder's entries: a name comes to mean an inode, another goes.
struct Edit {
  std::string folder;
  std::string added, removed;  // empty: none
  std::size_t inode = 0;
  bool flushed = false;
};

struct Disk {
  std::vector<Inode> inodes;
  std::map<std::string, std::size_t> sure;  // entries before the first edit
  std::map<std::string, std::size_t> now;   // with all edits
  std::vector<Edit> edits;

  void edit(const std::string& added, const std::string& removed, std::size_t inode);
  void run(const DiskCall& call, const fs::path& root);
};

std::string below(const fs::path& path, const fs::path& root) {
  const std::string text = path.lexically_relative(root).string();
  return text == "." ? "" : text;
}

void Disk::edit(const std::string& added, const std::string& removed, std::size_t inode) {
  edits.push_back({fs::path(added.empty() ? removed : added).parent_path().string(), added, removed, inode, false});
  if (!removed.empty()) now.erase(removed);
  if (!added.empty()) now[added] = inode;
}

void Disk::run(const DiskCall& call, const fs::path& root) {
  const std::string path = below(call.path, root);
  switch (call.op) {
    case DiskOp::kCreate:
      if (now.contains(path)) return;
      inodes.emplace_back();
      return edit(path, "", inodes.size() - 1);
    case DiskOp::kMakeFolder:
      inodes.push_back({true, "", 0});
      return edit(path, "", inodes.size() - 1);
    case DiskOp::kWrite:
      inodes[now.at(path)].bytes += call.bytes;
      return;
    case DiskOp::kRename:
      return edit(below(call.to, root), path, now.at(path));
    case DiskOp::kRemove:
      return edit("", path, 0);
    case DiskOp::kSync:
      if (const auto file = now.find(path); file != now.end() && !inodes[file->second].folder) {
        inodes[file->second].flushed = inodes[file->second].bytes.size();
      }
      for (Edit& edit : edits) edit.flushed = edit.flushed || edit.folder == path;
  }
}

Disk disk_of(const DiskImage& before) {
  Disk disk;
  for (const auto& [path, bytes] : before) {
    const bool folder = path.ends_with('/');
    disk.now[folder ? path.substr(0, path.size() - 1) : path] = disk.inodes.size();
    disk.inodes.push_back({folder, bytes, bytes.size()});
  }
  disk.sure = disk.now;
  return disk;
}

// The entries when of the edits not flushed those in `mask` arrived.
std::map<std::string, std::size_t> entries_of(const Disk& disk, std::size_t mask) {
  std::map<std::string, std::size_t> entries = disk.sure;
  for (const Edit& edit : disk.edits) {
    const bool arrived = edit.flushed || (mask & 1U) != 0;
    if (!edit.flushed) mask >>= 1U;
    if (!arrived) continue;
    if (!edit.removed.empty()) entries.erase(edit.removed);
    if (!edit.added.empty()) entries[edit.added] = edit.inode;
  }
  return entries;
}

// `arrived` of the bytes not flushed came, then nothing, or zeros up to the full length.
DiskImage image_with(const Disk& disk, const std::map<std::string, std::size_t>& entries, std::size_t arrived,
                     bool zeros) {
  DiskImage image;
  for (const auto& [path, number] : entries) {
    const std::string parent = fs::path(path).parent_path().string();
    if (!parent.empty() && !image.contains(parent + "/")) continue;  // its folder did not come
    const Inode& inode = disk.inodes[number];
    std::string bytes = inode.bytes.substr(0, std::min(inode.bytes.size(), inode.flushed + arrived));
    if (zeros) bytes.resize(inode.bytes.size(), '\0');
    image[inode.folder ? path + "/" : path] = std::move(bytes);
  }
  return image;
}

}  // namespace

DiskImage image_of(const fs::path& root) {
  DiskImage image;
  for (const auto& entry : fs::recursive_directory_iterator(root)) {
    const std::string path = entry.path().lexically_relative(root).string();
    if (entry.is_directory()) {
      image[path + "/"] = "";
    } else {
      std::ifstream file(entry.path(), std::ios::binary);
      image[path] = {std::istreambuf_iterator<char>(file), {}};
    }
  }
  return image;
}

void write_image(const DiskImage& image, const fs::path& root) {
  fs::remove_all(root);
  fs::create_directories(root);
  for (const auto& [path, bytes] : image) {
    if (path.ends_with('/')) {
      fs::create_directory(root / path.substr(0, path.size() - 1));
    } else {
      std::ofstream(root / path, std::ios::binary) << bytes;
    }
  }
}

void each_power_cut(const DiskImage& before, const fs::path& root, const std::vector<DiskCall>& calls, std::size_t done,
                    std::size_t byte_step, const std::function<void(const DiskImage&)>& visit) {
  Disk disk = disk_of(before);
  for (std::size_t i = 0; i < done; ++i) disk.run(calls[i], root);
  std::size_t on_their_way = 0;
  for (const Inode& inode : disk.inodes) on_their_way = std::max(on_their_way, inode.bytes.size() - inode.flushed);
  const auto open = std::ranges::count(disk.edits, false, &Edit::flushed);
  std::set<DiskImage> seen;
  for (std::size_t mask = 0; mask < std::size_t{1} << open; ++mask) {
    const auto entries = entries_of(disk, mask);
    for (std::size_t arrived = 0;; arrived = std::min(arrived + byte_step, on_their_way)) {
      for (const bool zeros : {false, true}) {
        const DiskImage image = image_with(disk, entries, arrived, zeros);
        if (seen.insert(image).second) visit(image);
      }
      if (arrived == on_their_way) break;
    }
  }
}

}  // namespace beltpick::test
