"""Lines of scripts/digests from JSON files of npdr: lines.py status.json | report.json."""
import json
import sys

with open(sys.argv[1], encoding="utf-8") as file:
    content = json.load(file)

if isinstance(content, list):  # of 'npdr status --json', in the order of the plan
    for artefact in content:
        print(artefact["label"], artefact["key"], artefact["path"], sep="\t")
else:  # what a report says of each method
    for method in content["checks"]:
        for kind in ("failed", "unknown", "unchecked"):
            for text in method[kind]:
                print(f"{method['method']}: {kind}: {text}")
        for reason in method["reasons"]:
            print(f"{method['method']}: reasons:", *(reason[key] for key in ("check", "what", "evidence", "advice")), sep=" | ")
