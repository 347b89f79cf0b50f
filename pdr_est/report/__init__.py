"""HTML reports: one file each that needs nothing but a browser.

* `walk`: the report and the result files of one walk (`pdr-est smooth`).
* `comparison`: the report of an experiment, which compares variants over many walks (`pdr-est experiment`).
* `evaluation`: the page of a track from another program beside the truth (`pdr-est evaluate`).
* `floor_plans`: the page of a floor plan (`pdr-est plan`).
* `live_page`: the page that `pdr-est live` serves.
* `plots`: the figures of a walk as SVG, with the colours and legends that all figures share.
* `background`: what lies below the track on the map of a walk.
* `page_templates`: what all templates share, and how numbers are written.
* `inline_assets`: scripts and styles inside a page, and the policy that allows only them.
* `packed_columns`: the numbers inside a page.

The templates (`*.html.j2`) lie in this folder, our scripts in `scripts`, and bundled libraries with their licences in
`assets`.
"""
