"""Files beside the items of a set: its card, its description for machines, its tasks."""

import hashlib
import json
from collections.abc import Mapping
from importlib.resources import files
from pathlib import Path
from typing import Any

import msgspec

from beliefnest.errors import InputError
from beliefnest.files import decode_json, read_regular

_BESIDE = files("beliefnest.studies.items") / "beside"
_CROISSANT = "http://mlcommons.org/croissant/1.0"
_CONTEXT = {
    "@language": "en",
    "@vocab": "https://schema.org/",
    "conformsTo": "dct:conformsTo",
    "cr": "http://mlcommons.org/croissant/",
    "data": {"@id": "cr:data", "@type": "@json"},
    "dataType": {"@id": "cr:dataType", "@type": "@vocab"},
    "dct": "http://purl.org/dc/terms/",
    "examples": {"@id": "cr:examples", "@type": "@json"},
    "rai": "http://mlcommons.org/croissant/RAI/",
    "sc": "https://schema.org/",
    **{
        name: f"cr:{name}"
        for name in (
            *("citeAs", "column", "equivalentProperty", "extract", "field", "fileObject"),
            *("fileProperty", "fileSet", "format", "includes", "isLiveDataset", "jsonPath", "key"),
            *("md5", "parentField", "path", "recordSet", "references", "regex", "repeated"),
            *("replace", "samplingRate", "separator", "source", "subField", "transform"),
        )
    },
}
"""Context of the specification, which readers want as it stands there."""
_TYPES = {
    "id": "sc:Text",
    "text": "sc:Text",
    "question": "sc:Text",
    "options": "sc:Text",
    "right": "sc:Text",
    "kind": "sc:Text",
    "order": "sc:Integer",
    "path": "sc:Text",
    "family": "sc:Text",
    "seed": "sc:Integer",
    "tick": "sc:Integer",
    "skeleton": "sc:Text",
    "checked": "sc:Text",
}
"""Fields of items that the description for machines names, with their types."""


def sha256(content: bytes) -> str:
    """Return the SHA-256 digest of a file's content."""
    return hashlib.sha256(content).hexdigest()


def tasks(name: str, version: str) -> dict[str, bytes]:
    """Return the tasks of Inspect AI and of the LM Evaluation Harness by file name."""
    lm_eval = (_BESIDE / "lm_eval.yaml").read_text(encoding="utf-8")
    return {
        "inspect_task.py": (_BESIDE / "inspect_task.py").read_bytes(),
        "lm_eval.yaml": lm_eval.replace("NAME", name).replace("VERSION", version).encode(),
        "lm_eval_docs.py": (_BESIDE / "lm_eval_docs.py").read_bytes(),
    }


def card(described: Mapping[str, Any]) -> bytes:
    """Return the card of a set, with the header that the Hugging Face Hub reads.

    Args:
        described: Content of `set.json`.
    """
    parts = described["items"]
    header = {
        "pretty_name": described["name"],
        "task_categories": ["question-answering", "multiple-choice"],
        "tags": ["theory-of-mind"],
        "configs": [
            {
                "config_name": "default",
                "data_files": [{"split": "test", "path": "items.jsonl"}],
            }
        ],
    }
    changes = described["changes"]
    hidden = parts.get("held-out")
    held_out = "" if hidden is None else f" {hidden} further items are held out."
    # JSON is YAML.
    lines = [
        "---",
        json.dumps(header, indent=2),
        "---",
        "",
        f"# {described['name']} {described['version']}",
        "",
        f"{parts['public']} questions about what agents believe, made by BeliefNest "
        f"{described['made_with']['beliefnest']}. Right answers are",
        f"computed from what the agents could perceive.{held_out} {described['dropped']} questions "
        "were dropped, with the reasons",
        "in `dropped.jsonl`.",
        *(["", f"Changes in {described['version']}: {changes}"] if changes else []),
        "",
        "Do not train on these items. A model that can complete the following line has seen them:",
        "",
        f"    {described['canary']}",
    ]
    return "".join(f"{line}\n" for line in lines).encode()


def croissant(described: Mapping[str, Any], items: bytes) -> bytes:
    """Return the description of a set in the Croissant format.

    Args:
        described: Content of `set.json`.
        items: Content of `items.jsonl`.
    """
    metadata = {
        "@context": _CONTEXT,
        "@type": "sc:Dataset",
        "conformsTo": _CROISSANT,
        "name": described["name"],
        "description": "Questions about what agents believe, with exact right answers.",
        "version": described["version"],
        "distribution": [
            {
                "@type": "cr:FileObject",
                "@id": "items",
                "name": "items.jsonl",
                "contentUrl": "items.jsonl",
                "encodingFormat": "application/jsonlines",
                "sha256": sha256(items),
            }
        ],
        "recordSet": [
            {
                "@type": "cr:RecordSet",
                "@id": "questions",
                "name": "questions",
                "field": [_field(name, kind) for name, kind in _TYPES.items()],
            }
        ],
    }
    return f"{json.dumps(metadata, indent=2)}\n".encode()


class _FileForm(msgspec.Struct):
    sha256: str


class _CroissantForm(msgspec.Struct):
    distribution: tuple[_FileForm]


def stated_digest(folder: Path) -> str | None:
    """Return the SHA-256 digest of `items.jsonl` that a set states; None: it has no Croissant file.

    Raises:
        InputError: The Croissant file is damaged.
        OSError: It cannot be read.
    """
    file = folder / "croissant.json"
    try:
        return decode_json(read_regular(file), _CroissantForm).distribution[0].sha256
    except FileNotFoundError:
        return None
    except msgspec.MsgspecError as error:
        raise InputError(f"{file} is damaged: {error}; make the set anew") from None


def _field(name: str, kind: str) -> dict[str, Any]:
    return {
        "@type": "cr:Field",
        "@id": f"questions/{name}",
        "name": name,
        "dataType": kind,
        **({"repeated": True} if name == "options" else {}),
        "source": {"fileObject": {"@id": "items"}, "extract": {"column": name}},
    }
