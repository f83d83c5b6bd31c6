# SPDX-License-Identifier: BSD-3-Clause
"""Many runs of a scene or a program: what varies, what is measured, and the engines that carry it (docs/batch.md).

From the file to the results: `tree` reads YAML, and `reader` a sweep; `plan` makes tasks of it; `run` runs one: a scene with
`metrics` and `stops`, or a `program` with `outputs`; `carry` hands chunks of them to `engines` or `batch`; `store` keeps what is
done; `charts` draws it. `study` is for programs that ride on all this.
"""
