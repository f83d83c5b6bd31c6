# SPDX-License-Identifier: BSD-3-Clause
"""The commands, scenes and files that a page shows.

A fenced block says what it is: ```bash are commands, one a line; ```yaml is a scene; ```text is what something prints;
```python is run by python_blocks_test.py; code in any other language, and Python below the comment <!-- PATH -->, is the
file of this package that the comment names.
"""
import re

# What a piece of `code` in the text begins with where it is a command; a name alone is only a name.
PROGRAMS = ('rosrun', 'roslaunch', 'rosservice', 'rostopic', 'rossrv', 'rosmsg', 'rosparam', 'rosnode', 'rospack', 'rosbag', 'rostest',
            'rbs', 'catkin_lint', 'catkin_make', 'cmake', 'ctest', 'doxygen')
COMMAND = re.compile(r'(?:%s) \S|(?:\./)?scripts/[a-z_]+(?: |$)' % '|'.join(PROGRAMS))
FENCE = re.compile(r'^```(\w*)\n(.*?)^```$', re.MULTILINE | re.DOTALL)
NAMED = re.compile(r'<!-- (\S+) -->\n\Z')
INLINE = re.compile(r'`([^`]+)`')
INDENTED = re.compile(r'\n\n {4}[^ \n].*')


def without_comment(line):
    return re.sub(r'\s+# .*', '', line).strip()


class Document:
    """`commands` in the order of the page, each once; `scenes` and `files`, the texts of its blocks; `faults`."""

    def __init__(self, text):
        self.commands, self.scenes, self.files, self.faults = [], [], {}, []
        self.faults += ['an indented block, which does not say what it is: ' + block.strip()
                        for block in INDENTED.findall(FENCE.sub('', text))]
        end = 0
        for block in FENCE.finditer(text):
            self.read_prose(text[end:block.start()])
            self.read_block(block.group(1), block.group(2), text[end:block.start()])
            end = block.end()
        self.read_prose(text[end:])

    def read_prose(self, text):
        spans = (' '.join(span.split()) for span in INLINE.findall(text))
        self.add(span for span in spans if COMMAND.match(span))

    def read_block(self, language, body, before):
        if language == 'bash':
            lines = body.replace('\\\n', ' ').splitlines()
            self.add(without_comment(line) for line in lines if line.strip() and not line.startswith('#'))
        elif language == 'yaml' and not NAMED.search(before):
            self.scenes.append(body)
        elif language == '':
            self.faults.append('a block that does not say what it is: ' + body[:60])
        elif language != 'text':
            name = NAMED.search(before)
            if name:
                self.files[name.group(1)] = body
            elif language != 'python':
                self.faults.append('%s without the comment <!-- PATH --> above it: %s' % (language, body[:60]))

    def add(self, commands):
        self.commands += [command for command in dict.fromkeys(commands) if command not in self.commands]
