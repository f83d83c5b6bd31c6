# SPDX-License-Identifier: BSD-3-Clause
"""Many runs of a scene: what varies, what is measured, and the engines that carry it (docs/batch.md).

From the file to the results: `tree` reads YAML; `plan` makes tasks of it; `run` runs one, with `metrics` and `stops`;
`carry` hands chunks of them to `engines` or `batch`; `store` keeps what is done; `charts` draws it.
"""
