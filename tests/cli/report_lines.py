"""Runs the lines that a report's "What next?" shows: those of shell, then those of Python."""
import html
import re
import subprocess
import sys

page = open(sys.argv[1], encoding="utf-8").read()
code = html.unescape(re.search(r"<code>(# Posteriors.*?)</code>", page, re.DOTALL)[1])
shell, python = code.split("# In Python", 1)
for line in re.findall(r"^npdr .*", shell, re.MULTILINE):
    subprocess.run(["bash", "-c", line], check=True)
found = {}
exec("# In Python" + python, found)
print(found["theta"].shape, *sorted(found["parameters"]))
